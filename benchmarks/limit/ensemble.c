/* Many balls, each with its own restitution and height.
   Given: balls, end, rtol, points of each. Found: the sum of the times of all last bounces. */
#include "ball.h"

static double spread(double from, double to, double number, double stride)
{
    return from + (to - from) * fmod(number * stride, 1);
}

static int ensemble(const double *given, double *found)
{
    found[0] = 0;
    for (int k = 0; k < (int)given[0]; ++k) {
        journal j = opened(2, given[1], given[3], 2, (const int[]){HEIGHT, SPEED});
        const double restitution = spread(0.85, 0.99, k + 1, 0.6180339887498949);
        const double drop = spread(1, 3, k + 1, 0.41421356237309515);
        found[0] += bounce(restitution, drop, given[1], given[2], &j);
        closed(&j);
    }
    return 1;
}

int main(int argc, char **argv)
{
    return repeated(argc, argv, ensemble);
}
