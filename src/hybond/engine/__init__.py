"""What a run does, written once, in Python that is printed as C and as Java.

What the modules of most rooms here may say is in `hybond.translate`; they are ordinary Python too,
and run as such where there is no library. Four rooms are ordinary Python alone: `tables` makes the
arrays of a model from its flat graph, `compiled` prints, builds and calls the library,
`interpreted` calls the modules themselves, `outcome` makes of what is written down the records of
a run.

`model.Model` is what a model brings along: tables, which `tables/` makes; `answers` has its
expressions and names, `method_numbers` the methods that a run may be asked for. `engine.Engine` is
one run: the state, the modes known so far, and all room to work in (`work`, and files that end in
`_records` or `_room`): every room may read these. `words` has the words of the subset. Else a room
reads itself and those above it alone, `run` all of them. Rooms, and in them files::

    algebra/
        blocks, products    arrays that grow, sparse rows; products of matrices, copies, the largest
        twofold             sums and products with twice the digits
        rounding, scaling, separate   what rounding is; powers of two; equations apart
        reached             unknowns that no given value reaches
        lu, lu_pair, qr, regular   square systems: real, complex, orthogonal, clearly regular
        lu_twofold          these with twice the digits
        sparse_lu           square systems in which each equation has few unknowns
        svd, least_distance        singular values; the point next to zero that keeps inequalities
        least_step          the smallest change that brings functions to what is asked
    complementarity/
        law_problem, law_roles    the question as a complementarity problem
        one_sided, lcp, lcp_forms, lemke, pivoting    without friction; its solution
        decided_closely     the same with twice the digits, where a leak tells laws apart
        all_branches, one_choice, choice, branch_records    few laws in doubt, by all their branches
        friction_disk, semidefinite    Coulomb's disk; whether there is one answer
        least_shares        which of many answers is of least leakage
    expressions/
        code, lookup, functions    laws as instructions; tables that they read; what has no value
        course_parts, course_ranges, course_records    what time alone does: its range over an
                            interval
        pairs, paired       what jumps: a finite part and an impulse; guards and rates on these
    reasons/
        facts, warned       why a run ended, what it warns of, in numbers
        noting              what was found not to hold
    inputs/
        interval, sampling, calls    pieces of inputs; signals set at instants; who is asked
    mode/
        equations, kept_modes           made ready: what is kept of them
        mode_records, mode_sizes        a mode, and what room it takes
        solving, limits     bond variables at an instant; limits of what has landed
        reading             what a step reads
        rows/
            storage, storage_bonds      co-energy, energy; which bond variables are their rates
            tableau, hidden_rows, elimination, elimination_records, taken_rows    eliminated
            elimination_of_another      those of a mode that differs in some
            drift           whether a small coefficient is rounding of what is given
            sources_of_time             sources that time alone moves
            acting, acting_records      which states act on which rates
        nonlinear/
            newton, newton_system, newton_step, dynamic_rows    Newton's method: what it makes zero,
                            its step, by which laws
            apart, solved_apart, apart_records    laws that do not know of each other, one by one
            sparse_step, single_terms    its step where there are many; what a row says of one
                            unknown alone
            slopes_bounded  what stands for slopes without bound
            unseen          what no law of a mode sees, and steps beside that
            guess, neighbours    where it begins
            damped, continuation    with shorter steps; on the way from laws with a resistance
                            beside
            led_up          from nothing known to all that is
            enclosed        one law alone, between two signs
            swung_over      ... over whose root steps swing from limit to limit
            several, one_root    whether laws may have several solutions
            others          another one, looked for
            branch, followed_records    the one that a motion follows: where Newton's method begins
            beside_jumps, at_jumps    solutions just beside a jump; one law at its jump
            level           what is rounding of what is known
            put_back, agreement    whether a solution holds; whether sources agree
            freedom, flat_sides    what a system leaves free; laws at a corner beside which they are
                            flat
        left_free/
            undetermined, leakage, lasting    what is free of a mode, and of laws, and what of it
                            lasts; least leakage
        digits/
            sizes, solved_sizes, chords, lesser_sizes    what its rounding is measured by
            connected, part_energies, reach    parts of the graph; how much energy there has been
                            on each; what would have an energy
            clusters, cluster_records    what settles within a moment, and what holds it
            fading          what rounding remembers
            closely         with all digits, where sums cancel
        comparisons/
            sums, straight_rates, sum_records    comparisons, and rates, that are sums of the state
            standing, standing_records    what stands at an equilibrium that nothing touches
    constraints/
        constraints         what a jump must fulfil
        bent_sources        what is free there, where sources are no linear functions of it
        impulse_ways, own_ways    the impulses that move what is stored there
        sparse_ways         where much is tied together
    impacts/
        impact_laws, shares, impact_records    Newton's for all, Poisson's; dependent contacts
        compliant, spring_steps    contacts as stiff springs
    surfaces/
        surface, reads, corners    surfaces, what they read; the modes around, corner by corner
        combine, blend, common_space    their combination, and what it is held to
        law_means           laws of one side push on the mean, too; friction that rests on it
        branch_table, slide_records    branches of laws in them; what is written
        outputs, averages   it is asked as a mode is
        values              what expressions read and how the state moves, in either
        onto, parted, jumps_near    back onto surfaces; some that have jumped away, or just do
        followers, follower_guards, led_by_bonds    machines that follow those that slide
    jumps/
        jump, trial         what is stored on entering a mode; every signal that follows
        jump_steps, led_jump, left_over    the areas of a jump: Newton's steps, and where these
                            lead nowhere; what is left that is rounding
        off_flat            where laws of storage have no slope
        untouched           what a jump does not reach stays as it was
        tied                motions that are nothing but what constraints lead along
    methods/
        stepping            one step of the method asked for
        control, off_kinks  steps that the error controls; those that begin on a kink
        scattered           steps whose stages are far from the motion that comes of them
        tolerances/
            scale, signal_sizes, lately    of what is stored and what is integrated
            moment_later    values kept while those of a moment later are looked at
            noise_here      the noise of rates measured anew where a step begins
            beside_flat     less where a law beside its flat end tells no more apart
            pushes          the energy that what pushes at rest would give in a moment
            defects         what a step stores beyond what its rates bring
            along_surfaces  what mean rates cancel from
            onset, strayed  what has not moved yet, by what it will be; what has gone astray
        explicit/
            dopri, step_room    Dormand and Prince
            fixed           forward Euler, the classical Runge-Kutta method
            failed_steps, one_instant    steps that cannot be; how long an instant is
        linear/
            exact, flow, flow_columns, linear_rows, balance, propagate, flow_records    linear
                            modes, propagated
            graded          slow motions of these beside fast ones
            rates_off       what errors leave in rates, where something exchanges fast
        implicit/
            radau, radau_stages, radau_slopes, radau_dense, radau_method, radau_room    implicit
                            steps
            nearer_slopes, near_roots, radau_factors    slopes over shorter differences, or beside
                            roots; what is solved for
            rates_in_stages    what errors leave in rates at their stages
            columns_together    slopes by many states at once
            hidden_peaks    what laws that bend do within a step, and nowhere it has looked
            stiffness       when ``auto`` goes over to them, and back
            beside_kinks    slopes of the side of a kink on which a step is
            whole_stages, whole_factors    all stages as one system, of states that are joined
            from_edges, beside_edges    stages where laws begin, and beside that
            settled_rates   rates that states move by, where a law is flat at rest
        quantised/
            qss, qss_start, qss_events, qss_band, qss_place, qss_room    quantised states
            qss_linear, qss_fit, qss_nodes    their rates: in linear modes, and in others
    planar/
        planar              friction in the plane: whether it holds
        stops, descent, planar_records    where slip ends and begins; its last part
    laws/
        entering            a mode entered, with laws of junctions or without
        laws                modes with laws of junctions: first what jumps, then what lasts
        ports, response     the graph with its laws left open, and what it says of them
        ports_together      which ports are tried together to learn that
        end_ports           which of their variables is the unknown of a time step
        law_branches, law_jumping, law_records    which branches are taken; which of an impulse
        law_instant, law_friction, law_rates    what laws may do; dry friction; how zeros move on
        law_answers         one question to them, answered
        law_parallel, law_shares    idle laws beside those that carry; friction that shares a load
        law_candidates, law_trials    whether a mode stands up to its laws; all that can be tried
        law_seconds, law_standing    more than one answer; the one that stands already
        gaps, gaps_held, gaps_left    whether the gap of a contact is the distance that its bonds
                            close, and goes on to be; whether it jumps away from it
        strike              impacts by a law that sees all closed contacts at once
        jumped_onto         contacts that a source has jumped onto, at which nothing arrived
        approach_left       what is left of an approach, where what drove it ends there
        impacts_held        the law of impacts put back into itself
        branches            branches in each of the modes around a surface
    guards/
        in_force            rules that are asked
        kept_sides          guards of what is rounding: it is what it was
        locate, locator     the first instant of a step at which a guard holds
        timetable, timetable_records    those that time alone decides: known ahead
        watching            which are looked for in a mode
        in_blocks, guard_values, guard_shape, candidates, turns, bracket    by samples
        rim                 up to where what a guard compares is rounding
        solved_guards, step_polynomials, quartic    by polynomials
        unresolved          what laws carry, beside its rounding
        kinks_on_surfaces   those that slide along with the motion pass nothing
        far_guards, kinks_afar      those that do not come to hold, which is seen at once
        at_rest, rest_limits, rest_records    those that would hold where the motion comes to rest
        kept_rests, sides_seen    what is known of these from step to step, and of their sides
        limits_crossed      what has come to one, waits there, and is asked again; a law that stood
                            just past its own counts as at zero up to there
        rests_asked         what rests where time, or a crossing beside it, asks for it
        naps, blurred       kinks that end no steps for a while; roots that a step does not tell
        moved_off           kinks that a motion begins at, and stays
        waiting             rules whose guards are on their way off their thresholds
        noise               whether samples are rough between neighbours
        together, within_rounding    what is one instant with it; as rounding cannot tell
        ends_at_guard       the step that ends there
    instant/
        settle, settling, enabled    trying modes at an instant until none is left; what a cycle is
                            told by; which rules hold
        back_by_dust        what crosses a surface and is led back by next to nothing
        small_jumps         jumps that are, and transitions over a surface and back
        ceasing             what is no cycle, as it ceases within the instant
        beginning           what is a priori where a run begins; states it cannot begin in
        staying, passed_over    what is known of the last trial; modes without a solution
        indeterminate       truths that depend on what is open
        open_integrals      ... and on integrals of that
        jump_balance        energy of a jump that comes from nowhere
        doubts, left_out, telling, told, instant    what is warned of, told and written down
    sliding/
        sliding, what_happened, met    after an event: which machines slide from there
        ways_on, filippov, crossings, additive, from_edge, ways_told    how the state goes on
        by_means            ... where laws would pull on the mean
        chatter             where fast switching leads what follows
        around, going_on    modes on both sides, tried; what goes on sliding, or leaves
    contacts/
        impacts_seen, accumulation, landing, landing_records    impacts that come to rest
        rest, unrest        the state at rest; why there is none
        coming_back         whether what was put together stays there
        in_turn             contacts without a rebound that open each other, ever faster
    timestepping/
        theta_step, step_newton, matrices, law_work    one step
        ringing, steps_damped             whether it rings, or laws lag; what is made with theta = 1
        step_sizes, step_laws, guessed    what it is measured by; laws at its end
        open_shares         who carries what
        touching_held       contacts that touch, held against the speeds at its end
        step_account        what sources gave, resistors took
        step_event, step_shown, step_records    what is written and shown
    checks/
        laws_held, another, guards_held    put back into themselves
        rates_apart         flows that are not what storages were moved by
        lost_between        what laws lose between the ends of steps
        means_held          laws of one side on the mean of fast switching
        bounds_held, energy_held    values that outgrow all bounds; energy that comes from nowhere
        shown, check_records    as read from outside; what was found
    looking/
        look, asked, known, energies    values and powers at points of a known motion
        led_back            points that a cubic leads beyond where a law ends
    run/
        motion              the executive: segment after segment
        step_motion         that of time-stepping, which locates nothing
        slid_at_limit       crossings that accumulate where surfaces meet, and slide from there
        noted, slips_followed    the end of a step; steps that follow slip in the plane
        ever_more           events that would be far too many long before the end
        kinks_passed, held_by_kinks, source_jumps    kinks of laws and of sources
        contradictions      sources that do not agree behind one
        guard_at_kink, ends_at_kink    a guard that holds at one; steps that end there
        courses_ahead       steps that see all of what time does
        jumps_ahead         steps that end next to jumps of time alone
        phases              how phases of the plant go on, such as the angle of a flywheel
        courses_kept        what is known of both, for a run that goes on
        roots_followed      which of several solutions of laws goes on, and where it ends
        others_told         that there is another one, where nothing says which, or none is followed
        struck_at_kink      sources that jump onto a contact
        edges, edges_met, roots_reached    where laws end, and how it goes on; roots that come to
                            rest
        within_error        what a step left beside an edge is put there
        rests_ahead         steps that end where a root comes to rest
        on_surfaces, level_jumps    a step along surfaces ends: the state is put back, unless they
                            jump; where a function in Python makes them
        stranded            motion that gets nowhere
        log, run_records, carried, trying    what is written, handed on, tried
        report, run, unit, unit_gaps    in a printed program: what is shown; the program; driven
                            by others, who do not know how they have come to where a gap jumps

What junction laws and implicit steps ask of it, and give to it:

State and values
    ``e.v`` are the values that expressions read (`2 * slots`), written by `values.set_values` (all
    but bond variables) and `solving.solve(e, mode, v)` (bond variables, into ``e.work.w`` and `v`;
    OK or NOT_FINITE with ``e.fault``). ``e.pre`` is what ``pre()`` reads at an instant. Stored
    quantities stand in `v` at ``model.stored_slot``: what is solved for is what is stored *there*.
    `solving.solve_read(e, mode, reads, v)` is the same for bond variables that are read in a step.
    `sizes.measure(e, mode, pair, xi, v, terms)`, before a guard is asked: what rounding of the
    signals that it reads is measured by, `xi` being what they were solved from. `sizes.seen_of(e,
    mode, v, x)`: ``mode.seen`` times the root of the energy of its part, `find_energies`, is how
    far each bond variable may reach.

Modes
    `equations.mode_of(e, state)` takes the equations of a mode into ``e.mode``. With laws left
    open: fill ``given[j]`` (a junction each: tableau.NOT_OPEN, COMMON, NET) and call
    `equations.make_equations(e, mode, given)` on a `mode_records.make_mode(model)` of your own,
    whose ``state`` `interval.configuration` has filled. The last sources of such a mode are its
    ports, in the order of junctions: ``mode.source[k] == -1 - j``; what is given from outside is
    ``mode.source_level[k]``.

Entering a mode
    `entering.enter(e, t, x, s, state, jump, stay)` is what settling calls. Without laws it is
    `trial.try_mode`. With laws (``model.laws > 0``) it calls
    `laws.enter_with_laws(e, t, x, s, state, jump, stay)`, which must leave the trial in ``e.trial``
    and ``e.v``, ``e.mode`` being its equations. It is made of

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
