"""What a model brings along: sizes and tables; `answers` has its expressions and its names.

Rows of a table in several columns begin at ``*_first[k]`` and end before ``*_first[k + 1]``. An
expression is known by its number; -1: a constant is beside it.
"""

from __future__ import annotations

from hybond.engine.words import Floats, Ints, Outside, given


@given
class Model:
    """One model.

    Slots: where a name stands in the vector `v` of values that expressions read: time, at 0; from
    those named here on inputs, their rates, integrated signals, stored quantities, efforts, flows,
    Booleans (ON, states of machines, comparisons of time). As many follow, the a priori values.
    """

    bonds: int
    storages: int
    integrals: int
    inputs: int
    watches: int
    machines: int
    switches: int  # controlled junctions and elements
    nodes: int
    slots: int
    input_slot: int
    input_rate_slot: int
    signal_slot: int
    stored_slot: int
    bond_slot: int
    on_slot: int
    at_slot: int
    most_sources: int
    """Sources that the equations of a mode may have, ports of junction laws counted."""
    most_dynamic: int  # rows that are evaluated anew each time, at the most; hidden ones left out

    # machines: those of the model, then those that stand for laws of junctions, as in the model
    state_first: Ints  # of each machine among all states; ``machines + 1`` entries
    start: Ints
    is_law: Ints
    leads_on: Ints  # per machine: whether it leads a law on where that would grow beyond all bounds
    laws: int  # how many machines stand for laws of junctions
    on_first: Ints  # of each state: what it switches on, in `on_switch`
    on_switch: Ints  # the node of each switch
    switch_machine: Ints
    rule_first: Ints  # of each machine: its rules, in order
    rule_source: Ints
    rule_target: Ints
    rule_landed: Ints  # 1, -1: in force where the machine has landed, if the reaction is so
    rule_piece: Ints  # 1: leads from one piece of a law to the next
    rule_reaction: Ints
    rule_value: Ints  # the guard as it is: an expression
    rule_doubted: Ints  # whether the guard may read no number, by its form
    rule_touches: Ints  # of each rule: whether it asks for both sides of a zero
    rule_watched: Ints  # whether time alone may make it true
    rule_test: Ints  # the guard while time passes: an expression. Pair k is the guard of rule k
    atom_first: Ints  # of each rule: the differences of its comparisons
    atom_value: Ints
    atom_size: Ints
    atom_zero: Ints  # the side of zero, 1 or -1, on which a comparison has its truth at zero
    turn_first: Ints  # of each rule, then of each kink: what is zero where these turn, inner first
    turn_atom: Ints  # it stands with the comparisons
    turn_pole: Ints  # whether something in these has no value there
    term_first: Ints
    """Of each, then of rates of signals: what it is a sum of, with `atom_level`; slot -1: none."""
    term_slot: Ints
    term_factor: Floats
    atom_level: Floats

    tells: int  # 1: what explains an event is written down with it
    told_first: Ints  # of each rule: the pairs that show what its guard reads
    told_pair: Ints
    givers: int  # sources that can give energy at a jump: their bond variable, the other, a sign
    giver_own: Ints
    giver_other: Ints
    giver_sign: Floats
    giver_follows: Ints  # whether its value reads what is stored, or bond variables

    # what each pair reads: guards in all their forms, then rates of integrated signals, gaps
    read_first: Ints
    read_slot: Ints

    # what elements say, by what is constant in a mode
    elements: int
    """Elements but storages and junctions: steady ones first, in order, then the others."""
    steady: int  # how many of them say the same in every mode
    element_node: Ints
    select_first: Ints
    """Of each element: what selects its part, in `select_kind` and so on; the last runs fastest."""
    select_kind: Ints
    """0: the state of a machine, 1: a comparison of time, 2: the level of an input."""
    select_index: Ints
    select_many: Ints
    element_first: Ints  # its parts, in `element_part`, in the order of what selects
    element_part: Ints
    part_power: Ints
    """Of each part: its first row of the power structure; its laws follow; then the next part's."""
    part_law: Ints
    part_dynamic: Ints  # of each part: the first of its dynamic rows
    part_source: Ints  # of each part: its source, or -1
    row_first: Ints
    row_column: Ints
    row_value: Floats
    discrete: int  # what beside machines selects equations: comparisons of time, levels of inputs
    discrete_kind: Ints
    discrete_index: Ints

    # dynamic rows: expression = 0
    dynamics: int
    dynamic_kind: Ints  # 0: power structure, 1: law
    dynamic_node: Ints
    dynamic_source: Ints
    dynamic_impulsive: Ints
    """Whether it is that of a source; and of a law which was declared impulsive."""
    dynamic_pair: Ints  # of one that has to say if it leaves out an impulse: its pair, else -1
    dynamic_value: Ints
    dynamic_rounding: Ints  # what rounding of it is measured by
    dynamic_partner: Ints  # of a law that gives one variable of a bond: the other one, or -1
    dynamic_way: Floats  # the sign with which a resistance beside the law would add that
    dynamic_follows: Ints  # whether it is a two-port whose modulus may jump with what is stored
    dynamic_affine: Ints  # whether its slopes do not read bond variables
    dynamic_jumps: Ints  # 1: a law that jumps where what it reads is zero, 2: bends or is flat
    dynamic_breaks: Ints  # whether it may jump anywhere
    dynamic_fixed: Ints  # whether it reads nothing but bond variables, and its slopes are numbers
    dynamic_free: Ints  # the first of the bond variables that it forbids to carry an impulse
    free_column: Ints
    law_reads: Ints  # of each row: the first of the bond variables that it reads, ...
    law_column: Ints  # ... whether it has a slope by them or not
    hang_first: Ints  # of each source, dynamic row, storage, integrated signal: ...
    hang_slot: Ints  # ... the values that it hangs on
    slope_first: Ints
    slope_column: Ints
    slope_value: Ints
    slope_constant: Floats
    slope_flat: Ints  # of a law that gives one variable of a bond: whether it is zero on a stretch
    flats: int  # how many are
    curved: int  # how many laws have slopes that read bond variables
    slope_sign: Ints  # that a slope has whatever its law reads, 1 or -1; 0 if none is told
    slope_like: Ints  # the first slope of its row that is `beside` and `times` the same, ...
    slope_like_sign: Ints  # ... and the sign of that: 1, -1 or 0
    slope_times: Floats
    slope_beside: Floats
    slope_isolated: Ints  # by the one variable that it reads: whether one is zero at points alone
    frozen_first: Ints
    """Slopes with moduli held: what the structure is at an instant."""
    frozen_column: Ints
    frozen_value: Ints
    frozen_constant: Floats
    frozen_isolated: Ints  # of a source: whether one that is zero is so at points only
    drift_value: Ints
    """The time derivative of each row at constant bond variables, and its slopes."""
    drift_first: Ints
    drift_column: Ints
    drift_slope: Ints
    drift_constant: Floats

    # sources
    sources: int
    source_node: Ints
    source_bond: Ints
    source_value: Ints
    source_constant: Floats
    source_rate: Ints  # -1: zero
    source_linear: Ints  # whether the rate does not read bond variables
    source_curved: Ints  # whether the slopes of the rate read bond variables
    source_bent: Ints  # whether the value is not linear in what is stored and bond variables
    source_size: Ints
    """What the magnitudes of all its terms add up to, where it has kinks; -1: it has none."""
    source_timed: Ints  # whether the value depends on time and inputs only
    look_first: Ints
    """Of each source: the bonds that its value reads, by their variables or by what is stored."""
    look_bond: Ints
    source_first: Ints  # of each source: the slopes of its rate by bond variables
    source_column: Ints
    source_slope: Ints
    source_slope_constant: Floats

    # junctions
    junctions: int
    junction_kind: Ints
    junction_switch: Ints  # -1: not controlled
    end_first: Ints
    """Of each junction: its bonds, and 1 where one points at it, else -1."""
    end_bond: Ints
    end_sign: Ints

    # storage
    storage_bond: Ints
    storage_kind: Ints  # 0: a C, 1: an I
    storage_sign: Ints  # 1 if the bond points at it
    storage_start: Floats
    storage_pseudo: Ints
    storage_impulse: Ints  # of which kind its impulses are, by domain
    bond_impulse: Ints  # of which kind those of each effort are, then of each flow
    impulse_kinds: int
    bond_class: Ints  # the same kinds by domain and island
    classes: int
    islands: int  # parts of the graph between which no rounding passes, whatever is ON
    bond_island: Ints
    bases: int  # parts that remain one, whatever is OFF
    bond_base: Ints
    most_parts: int  # of these that store anything
    storage_base: Ints  # numbered as storages stand
    co_energy: Ints  # the law of each stored quantity, -1: the row of `stiff_constant` is
    co_rounding: Ints  # the law of what its rounding is measured by, -1: its value
    stiff_first: Ints  # of each: derivatives of its co-energy variable, by those of its storage
    stiff_other: Ints
    stiff_value: Ints
    stiff_constant: Floats
    power_first: Ints
    """Of each stored quantity's law, then each stiffness: powers that it is a sum of, or none."""
    power_degree: Ints
    power_factor: Floats
    groups: int  # storages that are not linear
    group_first: Ints
    group_storage: Ints
    point_first: Ints
    """Of each group: points of Gauss's formula for its energy; none: found with error control."""
    point_at: Floats
    point_weight: Floats
    bend_first: Ints  # of each group: values that change sign at kinks and jumps of its laws
    bend_value: Ints
    energy_law: Ints  # of each group: its energy from zero on in closed form, -1: not known

    # where power enters and leaves, over bonds on which effort times flow is power
    suppliers: int  # bonds of sources
    supplier_bond: Ints
    supplier_sign: Ints  # 1 if the bond points away from the source
    dissipators: int  # ports of resistors
    dissipator_bond: Ints
    dissipator_sign: Ints  # 1 if the bond points at the resistor

    # signals, inputs, time
    integral_rate: Ints  # pair ``rules + k`` is the same on pairs
    integral_size: Ints  # what its rounding is measured by
    integral_start: Floats
    signals_act: int  # whether any of these rates reads an integrated signal
    signal_acts: Ints
    """Of each integrated signal: whether any rate, a law's or one of these, reads it."""
    input_kind: Ints
    """0: constant, 1: table that is held, 2: with straight lines, 3: pulses, 4: from outside."""
    input_first: Ints
    """Its numbers. 0: level. 1, 2: times, values. 3: period, duty, high, low, phase. 4: start."""
    input_number: Floats
    input_period: Floats
    """The time after which a table repeats; 0: it does not."""
    level_first: Ints
    """Of each table that is held: which of its levels a piece has, in `level_of`."""
    level_of: Ints
    samples: int  # signals that are set at instants and held between them
    sample_signal: Ints  # which integrated signal, of rate zero, each is
    sample_value: Ints
    sample_size: Ints  # what is sampled, and the size of its terms: expressions
    sample_every: Floats
    sample_phase: Floats
    called: int
    """Inputs of kind 5, with breaks for numbers; only runs by hybond have these, and blocks."""
    input_rated: Ints
    """Of each input: whether the rate is read, if it is called."""
    blocks: int
    sample_block: Ints
    """Of each sample: the block that is called, with -1 for its signal and value; or -1."""
    most_called: int  # values that a block reads or sets, at the most
    block_first: Ints
    """Of each block: the expressions that it reads."""
    block_value: Ints
    block_set: Ints
    """Of each block: the integrated signals that it sets, in `block_signal`."""
    block_signal: Ints
    watch_slope: Floats
    """A comparison of time: ``slope * time + offset`` is compared with zero."""
    watch_offset: Floats
    watch_operator: Ints  # 0: <, 1: <=, 2: >, 3: >=
    watch_time: Floats

    # states that hold at an instant only
    priors: int  # sources whose law reads ``pre()``
    prior_first: Ints
    """Of each: the switches that must be ON for it to act."""
    prior_switch: Ints
    prior_machine: Ints  # the machine whose law brought it in, or -1
    prior_state: Ints
    """The state of that machine in which it acts so."""
    prior_read: Ints
    """Of each: where what it reads so stands in `prior_slot`; then the next one's."""
    prior_slot: Ints
    prior_limit: Ints
    """What that is where its machine has landed, as a number of a value; -1: the constant."""
    prior_limit_constant: Floats

    # laws of junctions: a port for each junction whose law is left open
    ports: int
    port_machine: Ints
    port_node: Ints
    port_rank: Ints  # its place by name
    port_junction: Ints
    port_domain: Ints
    port_two_sided: Ints
    """Whether the common variable may have either sign: dry friction."""
    port_planar: Ints  # whether it is one of two that share a disk
    port_impulsive: Ints
    port_affine: Ints
    """Whether its limits of friction are affine in bond variables, with constant slopes."""
    port_pseudo: Ints  # whether effort times flow is no power there
    port_force: Ints
    """The bond variable of the source that friction brought in, or -1, and its sign there."""
    port_force_sign: Ints
    port_bounce: Ints
    """The state in which its machine strikes, or -1."""
    port_limit: Ints
    """Options of laws: an expression, -1 if it is constant, -2 if there is none."""
    port_limit_constant: Floats
    port_breakaway: Ints
    port_breakaway_constant: Floats
    port_gap: Ints
    port_gap_constant: Floats
    port_gap_rate: Ints
    """How fast it opens: an expression; -1: the constant; -2: it is none, or does not change."""
    port_gap_rate_constant: Floats
    port_gap_pair: Ints  # the gap among the pairs; -1 if it is constant
    port_gate: Ints
    port_gate_constant: Floats
    port_gate_pair: Ints
    port_restitution: Ints
    port_restitution_constant: Floats
    port_stiffness: Ints
    port_stiffness_constant: Floats
    pair_first: Ints
    """Rows ``2 k`` and ``2 k + 1``: common and net variable of port k, by bond variables."""
    pair_column: Ints
    pair_value: Floats
    limit_first: Ints
    """The same rows: slopes by bond variables of limit and breakaway of port k."""
    limit_column: Ints
    limit_slope: Ints
    limit_slope_constant: Floats
    disks: int  # friction in the plane: two junctions that share a disk
    disk_machine: Ints
    disk_port: Ints  # the two ports of each disk
    disk_heading: Ints
    """What it keeps between events, among the integrated signals: the direction of slip."""
    disk_slow: Ints
    """The speed at which slip ends, or below zero, up to which the direction counts."""
    law_planar: Ints
    """Of each machine: whether it is friction in the plane."""
    oriented: int
    """Whether `orient` is there; else time-stepping chooses, configuration by configuration."""
    orient: Ints
    """Whether a port's net variable is given, for all that other machines switch, last fastest."""
    orient_place: Ints
    """Of each state of a machine: what it adds to the place among these settings."""

    # contacts that may come to rest, and what they then carry
    contact_at: Ints
    """Of each state: the contact that it closes by an impact law, or -1."""
    contact_machine: Ints
    contact_state: Ints
    contact_rest: Ints  # the state that the machine rests in
    reactions: int
    reaction_first: Ints
    """Of each contact: its reactions."""
    reaction_column: Ints
    """The bond variable that the contact carries at rest."""
    reaction_own: Floats
    """Sign of the impact law's value in what must vanish at rest."""
    reaction_law: Ints
    reaction_law_constant: Floats
    reaction_prior: Ints  # of each: its law among those that read ``pre()``, or -1
    prescribed_first: Ints  # of each reaction: bond variables whose sum must vanish at rest
    prescribed_column: Ints
    prescribed_sign: Floats

    # switching surfaces: where two rules of a machine, forth and back, share one function
    surfaces: int
    surface_machine: Ints
    surface_below: Ints
    surface_above: Ints  # the states where the function is negative, and positive
    surface_up: Ints
    surface_down: Ints  # the rules that lead there
    surface_value: Ints
    surface_twin: Ints  # of each pair: 1 if they are one surface, -1 if turned round
    surface_first: Ints  # of each surface: the slopes of its function
    surface_kind: Ints
    """What it is a slope by: `READS_` of surfaces/reads.py."""
    surface_index: Ints
    surface_slope: Ints
    surface_constant: Floats
    surface_jump_first: Ints
    surface_jump: Ints  # of each surface: kinks, or those behind them, at which it may jump
    surface_rest: Ints  # of each: what else the rule asks for that leads up, then the other's
    rest_value: Ints
    rest_moves: Ints  # whether that changes while time passes
    rest_pair: Ints  # if it does: the pair, and what is so in motion, that it does not hold
    rest_test: Ints
    rest_atom: Ints  # the differences of its comparisons, behind those of rules; then the next's
    followers: int  # machines that read states of others, which may slide: surfaces/followers.py
    prior_followers: int  # how many of them read what states were before
    follower: Ints
    follower_asks: Ints  # 0: reads states, time, inputs alone, 1: what is stored, 2: bonds, too
    machine_follows: Ints  # of each machine, if there are any: whether it is one of them
    swayers: int  # those that make the surface of another jump, and read some that may slide
    swaying: Ints
    reader_first: Ints  # of each machine, if there are any: those that read it, by their place
    reader: Ints
    kinks: int  # what changes its sign where a law, source or rate has a kink: a step ends there
    slide_kinks: int  # those behind them at which nothing but surfaces jump
    kink_atom: int  # the first of them among comparisons, in order, behind all others
    kink_pair: Ints  # what each reads stands with the pairs
    kink_switch: Ints  # what is to be ON for anything to feel it, -1: nothing
    kink_rest: Ints  # what is at rest where it is zero, the root of which is here; -1: nothing
    rests_apart: int  # how many of these read others than what is compared at the kink
    kink_rooted: Ints  # whether a law takes the root of it, or of what it is a multiple of
    kink_meets: Ints  # whether all that is said of it has one value there as well
    kink_node: Ints  # the element that says it; -1: the rate of a signal
    jumping_gaps: int
    jumping_gap: Ints  # kinks at which the gap of a contact jumps
    timed_laws: int  # those of laws and sources, which come first
    timed_jumps: int
    timed_jump: Ints  # what depends on time and known inputs, and jumps by one at least
    edges: int  # what is nowhere negative: beyond, a root in a law has no value
    begins: int  # these, and behind them what roots are taken of on both sides
    rooted: int  # so many of these by roots that are written; others: powers, roots if turned
    edge_met: Ints  # 1: where a kink is a root from both sides; 2: a branch takes no root beyond
    begin_bond: Ints  # the bond variable that each of these is; -1: none
    edge_value: Ints  # behind them what is clamped there: below zero where a valve is shut
    edge_size: Ints  # what the magnitudes of its terms add up to
    bends: float  # what arguments of laws are beside a limit on one side alone, at least; 0: none
    edge_bonds: int
    edge_bond: Ints  # the bond variables that these read
    level_pairs: int
    level_pair: Ints  # two that laws compare, which all have one value where these are equal

    # courses: what time, or a phase, does where a step reads it; parts work on parts before them
    courses: int
    course_root: Ints
    course_group: Ints  # of those that are terms of one sum: the same number
    course_value: Ints
    course_phase: Ints  # 1: what the plant moves has a say in it, 0: all of it is known
    course_whole: Ints  # the part that is the comparison of which it is a term, -1: none, several
    course_first: Ints  # of each: when it counts, by kind and number; a kind is one of four
    course_user: Ints  # 0: always, 1: where a source acts, 2: a switch is ON, 3: a rule is asked
    course_index: Ints
    course_place: Ints  # who says it: an element, -1: the rate of a signal, else ``-2 - rule``
    course_signals: int  # integrated signals that they read, each behind what its rate reads
    course_signal: Ints
    course_plants: int  # bond variables and what is stored: the slots that they read
    course_plant: Ints
    course_nodes: int
    course_op: Ints
    course_left: Ints
    course_right: Ints
    course_third: Ints
    course_number: Floats
    arguments: int  # of functions that turn, in laws and sources: what these are largest by
    argument_value: Ints

    # forms, for what is propagated exactly: bond variables, states, then generators, with factors
    form_first: Ints
    """Values of sources, rates of sources, dynamic rows, rates of integrated signals."""
    form_column: Ints
    form_value: Floats
    form_why: Ints
    """The number of the reason why there is none, or -1."""
    forms_why: int  # that of why no mode can be propagated, or -1
    reasons: int
    generators: int  # functions of time; row k is the rate of the k-th by all of them
    generator_one: int  # the one that is 1
    generator_first: Ints
    generator_column: Ints
    generator_rate: Floats
    generator_value: Ints
    generator_moving: Ints  # whether each is no polynomial of time

    # what is printed
    outputs: int
    output_value: Ints
    until: float
    span: float  # what thresholds of time are parts of, s
    ends: int  # the machine whose first transition ends the run, or -1
    points: int
    rtol: float
    atol: float  # nan: none is given
    max_step: float
    event_tol: float
    max_writes: int
    max_events: int
    max_steps: int  # between two events
    method: int  # by the numbers of `tables.options.METHODS`
    step: float  # of rk4, euler and moreau-jean
    theta: float  # of moreau-jean: how much the end of a step weighs in its smooth part
    slides: int  # 1: time goes on along surfaces into which both sides push; 0: refused
    impact: int
    """The law of impacts at several contacts: NEWTON and the others of impacts/impact_records."""
    impact_exponent: float  # of springs that contacts are: 1 linear, 1.5 Hertz
    decided: int  # 1: least leakage decides what a guard reads and the equations leave open
    answers: Outside
