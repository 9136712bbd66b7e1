/* Shortest: the shortest decimal that reads back as the same double; of several as short, the
 * nearest to it; of two as near, the one whose last digit is even. */
#ifndef GD_BASE_SHORTEST_H
#define GD_BASE_SHORTEST_H

#include <cstdint>

namespace gd
{

/* 0.DIGITS x 10^point. */
struct decimal {
    /* 17 of them, the first one not 0; zeros behind the last one that counts */
    std::uint64_t digits;
    int point;
};

/* Of a positive finite double. Thread-safe, some 10 ns. */
decimal shortest(double value);

} // namespace gd

#endif
