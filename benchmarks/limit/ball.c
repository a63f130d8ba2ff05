/* A ball that bounces. Given: end, restitution, drop, rtol, points. Found: bounces, the last one. */
#include "ball.h"

static int ball(const double *given, double *found)
{
    journal j = opened(2, given[0], given[4], 2, (const int[]){HEIGHT, SPEED});
    found[1] = bounce(given[1], given[2], given[0], given[3], &j);
    found[0] = (double)j.events;
    closed(&j);
    return 2;
}

int main(int argc, char **argv)
{
    return repeated(argc, argv, ball);
}
