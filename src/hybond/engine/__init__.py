"""What a run does, written once, in Python that is printed as C and as Java.

What the modules of most rooms here may say is in `hybond.translate`; they are ordinary Python too,
and run as such where there is no library. Four rooms are ordinary Python alone: `tables` makes the
arrays of a model from its flat graph, `compiled` prints, builds and calls the library,
`interpreted` calls the modules themselves, `outcome` makes of what is written down the records of
a run.

`model.Model` is what a model brings along: tables, which `tables/` makes; `answers` has its
expressions and names. `engine.Engine` is one run; it holds the state, the modes known so far, and
all room to work in. Data flows so::

    tables -> Model
    elimination, tableau      rows of a mode, eliminated
    equations, kept_modes     those made ready: engine.Mode, kept (the least recently used goes)
    newton, storage, leakage  bond variables at an instant; co-energy, energy; least leakage
    reading, sizes            those that are read in a step; what their rounding is measured by
    sums, straight_rates      comparisons, and rates, that are sums of the state in a mode
    newton_system, dynamic_rows     what Newton makes zero; rows whose laws are evaluated
    beside_jumps              laws that hold just beside a jump of one of them, to rounding
    damped, continuation      Newton with shorter steps, where full ones do not end; on the way from
                              laws with a resistance beside them, where these do not either
    put_back, freedom         whether a solution holds; directions that a linear system leaves free
    undetermined              what laws leave free at the values that hold
    jump                      entering a mode: constraints, impulses
    trial, entering, settle   trying modes at an instant until none is left (staying: what is
                              known of the last one; passed_over: modes without a solution)
    values, scale, stepping   values while time passes; tolerances; one step
    control, dopri, exact     steps that the error controls: Dormand and Prince, or what is
                              propagated: flow (which modes are linear, and their matrix, by
                              linear_rows and balance), propagate (its exponential)
    fixed                     forward Euler and the classical Runge-Kutta method
    qss, qss_start            quantised states: steps from one quantum event to the next, qss_events
                              (qss_band: when; qss_place: where linearly implicit ones are put);
                              rates by the flow of a linear mode (qss_linear) or fitted (qss_fit)
    locate                    the first instant of a step at which a guard holds: locator (what
                              is kept), guard_values, guard_shape, candidates, bracket;
                              solved_guards (those that are polynomials: step_polynomials,
                              quartic);
                              together (what is one instant with it, kinks), one_instant (how
                              long that lasts); ends_at_guard (the step that ends there)
    bounds_held               values that outgrow all bounds
    roots_reached             what roots on both sides of rest bring there stays there
    sampling, calls           signals set at instants; inputs and blocks that are asked for
    motion                    the executive: segment after segment
    radau, radau_stages       implicit steps
    stiffness                 when ``auto`` goes over to them, and back
    ports, law_branches, laws laws of junctions: the graph seen from them, which branches are taken
    gaps                      whether the gap of a contact is the distance that its bonds close
    law_instant, law_friction what laws may do at an instant, dry friction among them
    law_rates                 how what is zero moves on: which idle diode conducts
    law_parallel              who of laws beside each other carries, and what of that stays open
    law_answers               one question to them, answered
    law_candidates            whether a mode stands up to its laws; all branches, where that cannot
                              be asked
    strike                    impacts by a law that sees all closed contacts at once: impact_laws
                              (Newton's for all, Poisson's), shares (of dependent contacts),
                              compliant and spring_steps (contacts as stiff springs)
    law_problem, lcp_forms, lemke   these as one complementarity problem, and its solution:
                              law_roles (how each takes part), one_sided (without friction)
    all_branches, one_choice  few laws in doubt: none, one or several answers, by all their branches
    planar, stops, descent    friction in the plane: whether it holds, where slip ends and begins
    accumulation, rest, landing     contacts that come to rest
    sliding, going_on         after an event: which machines slide from there, and what is written
    met, ways_on, filippov    the surfaces met, how the state goes on from them: additive, crossings
    combine, corners, branches      the modes around surfaces; the branches of laws in each of them
    blend, averages, onto     their combination, as a mode is asked for; back onto the surfaces
    step_motion, theta_step   time-stepping: the executive that locates nothing, one step: matrices,
                              step_laws, guessed (the branches of the step before), open_shares and
                              step_shares (who carries what), end_ports, step_event, step_shown
    log                       what is written down; in its place a program has
    report, run               what is printed; options; the program

What junction laws and implicit steps ask of it, and give to it:

State and values
    ``e.v`` are the values that expressions read (`2 * slots`), written by `values.set_values` (all
    but bond variables) and `solving.solve(e, mode, v)` (bond variables, into ``e.work.w`` and `v`;
    OK or NOT_FINITE with ``e.fault``). ``e.pre`` is what ``pre()`` reads at an instant. Stored
    quantities stand in `v` at ``model.stored_slot``: what is solved for is what is stored *there*.
    `solving.solve_read(e, mode, reads, v)` is the same for bond variables that are read in a step.
    `sizes.measure(e, mode, pair, xi, v, terms)`, before a guard is asked: what rounding of the
    signals that it reads is measured by, `xi` being what they were solved from. `sizes.seen_of(e,
    mode, x)`: ``mode.seen`` times the root of ``e.energy`` is reach_of_bonds.

Modes
    `equations.mode_of(e, state)` takes the equations of a mode into ``e.mode``. With laws left
    open: fill ``given[j]`` (a junction each: tableau.NOT_OPEN, COMMON, NET) and call
    `equations.make_equations(e, mode, given)` on a `engine.make_mode(model)` of your own, whose
    ``state`` `interval.configuration` has filled. The last sources of such a mode are its ports, in
    the order of junctions: ``mode.source[k] == -1 - j``; what is given from outside is
    ``mode.source_level[k]``.

Entering a mode
    `entering.enter(e, t, x, s, state, jump, stay)` is what settling calls. Without laws it is
    `trial.try_mode`. With laws (``model.laws > 0``) it calls
    `laws.enter_with_laws(e, t, x, s, state, jump, stay)`, after Trials._with_laws, which must leave
    the trial in ``e.trial`` and ``e.v``, ``e.mode`` being its equations. It is made of

    * `trial.begin_trial(e, t, x, s, state)`: takes the mode, writes the values on entering it;
    * `trial.take_factors(e, e.mode, e.v)`, `trial.jump_into(e, x, after)`: the jump (what it does
      is ``e.moved``, impulses are ``e.impulses``);
    * `trial.finish_trial(e, t, x, s)`: with ``e.trial.x`` and ``e.moved`` set, the signals;
    * ``e.trial.struck`` and ``e.trial.through``: the branches that carried the impulses, where
      others last; ``e.trial.dusted``.

    `laws.observe(e, v)` is called at the end of each step, with the values there.

Steps
    `stepping.start(e, t, y, t_bound, jumped)`, `stepping.step(e, t_end)` and
    `stepping.retry(e, t_end)` choose by ``model.method``; a step is in ``e.step`` (`engine.Step`:
    t0, t1, y0, y1, f0, f1 and the coefficients of ``x ... x^4``, a row each, in ``dense``).
    `values.field(e, e.mode, t, y, rate)` is the rate, `scale.tolerance(e, y0, y1, out)` the error
    that a step may make. A radau brings `radau_start`, `radau_step` and `radau_retry` with the same
    arguments.
"""
