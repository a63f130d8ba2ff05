
/* Steps of members, kept so that all of them are looked at once they have run. */

/* Have room for so many steps; false without memory. */
static bool room_for_steps(HybondMembers *all, size_t wanted, size_t states, size_t machines)
{
    if (wanted <= all->wide) {
        return true;
    }
    const size_t wide = 2 * wanted + 64;
    const size_t size = sizeof(double);
    double *time = realloc(all->time, 3 * wide * size);
    all->time = time != NULL ? time : all->time;
    double *state = realloc(all->state, (3 * wide * states + 1) * size);
    all->state = state != NULL ? state : all->state;
    double *dense = realloc(all->dense, (4 * wide * states + 1) * size);
    all->dense = dense != NULL ? dense : all->dense;
    int *motion = realloc(all->motion, wide * sizeof(int));
    all->motion = motion != NULL ? motion : all->motion;
    int *place = realloc(all->place, (2 * wide * machines + 1) * sizeof(int));
    all->place = place != NULL ? place : all->place;
    if (time == NULL || state == NULL || dense == NULL || motion == NULL || place == NULL) {
        return false;
    }
    all->wide = wide;
    return true;
}

/* Keep the steps of a member, to look at them once all have run; false if something lies between
 * them, or without memory. */
static bool keep_steps(HybondMembers *all, HybondSets *sets, int k)
{
    const Report *log = all->run->log;
    const Model *m = all->run->model;
    const size_t states = (size_t)(m->storages + m->integrals);
    const size_t machines = (size_t)m->machines;
    const size_t steps = (size_t)log->steps;
    const size_t first = all->laid;
    if (!room_for_steps(all, first + steps, states, machines)) {
        return false;
    }
    for (int j = 1; j < log->steps; ++j) {
        if (log->step_time->at[3 * j] != log->step_time->at[3 * j - 1]) {
            return false;
        }
    }
    memcpy(all->time + 3 * first, log->step_time->at, 3 * steps * sizeof(double));
    memcpy(all->state + 3 * states * first, log->step_state->at, 3 * states * steps * sizeof(double));
    memcpy(all->dense + 4 * states * first, log->step_dense->at, 4 * states * steps * sizeof(double));
    for (int j = 0; j < log->steps; ++j) {
        const size_t at = first + (size_t)j;
        const int *place = log->step_place->at + (2 + 2 * machines) * (size_t)j + 2;
        const bool on = j > 0 && goes_on(log, j, m->machines);
        all->motion[at] = on ? all->motion[at - 1] : (int)at;
        memcpy(all->place + 2 * machines * at, place, 2 * machines * sizeof(int));
    }
    unsigned char *struck = sets->struck + (size_t)k * (size_t)sets->measured;
    for (int j = 0; j < sets->measured; ++j) {
        struck[j] = 0;
        for (int h = 0; h < log->hits; ++h) {
            struck[j] |= sets->measure[j] == m->bond_slot + log->hit->at[h];
        }
    }
    sets->energy[k] = fmin(all->run->e->energy, 1.7976931348623157e308);
    sets->stepped[k] = log->steps;
    all->laid += steps;
    return true;
}

/* Look at points of one motion of a member, from point `from` to before `to`. */
static int look_into_kept(HybondMembers *all, const HybondSets *sets, const HybondLooked *p,
                          int from, int to)
{
    HybondRun *look = all->look;
    const size_t machines = (size_t)look->model->machines;
    const int first = all->motion[p->step[from]];
    const int *place = all->place + 2 * machines * (size_t)first;
    if (setjmp(look->arena.spent) != 0) {
        return ORDINARY;
    }
    if (look_into(look->e, look->l, all->time[3 * (size_t)first], place, place + machines, 0, NULL,
                  0, 0, NULL, sets->energy[p->member[from]]) != OK) {
        return ORDINARY;
    }
    points_within(look->l, to - from, p->t + from, p->step + from, all->time, all->state,
                  all->dense);
    ask_for(look->l, p->slots, p->slot);
    return look_values(look->e, look->l, p->out + (size_t)from * (size_t)p->slots);
}

/* Look at points in the steps that the last call of `hybond_members_run` has kept. */
SHOWN void hybond_members_look(HybondMembers *all, const HybondSets *sets, HybondLooked *points)
{
    const HybondLooked *p = points;
    int member = -1;
    for (int from = 0, to = 0; from < p->points; from = to) {
        const int own = p->member[from];
        const int motion = all->motion[p->step[from]];
        for (to = from + 1; to < p->points && all->motion[p->step[to]] == motion; ++to) {
        }
        if (own != member) {
            const double *number = sets->number + (size_t)own * (size_t)sets->entries;
            for (int j = 0; j < sets->entries; ++j) {
                *sets->place[j] = number[j];
            }
            restore(&all->look->arena, &all->looking);
            member = own;
        }
        if (look_into_kept(all, sets, p, from, to) != OK) {
            points->blind[own] = 1;
        }
    }
}
