/* Computes the shortest decimal that reads back as the same double. Among the decimals of that
 * length it returns the nearest to the double; in a tie, the one with an even last digit. */
#ifndef GD_BASE_SHORTEST_H
#define GD_BASE_SHORTEST_H

#include <cstdint>

namespace gd
{

/* The decimal 0.DIGITS x 10^point. */
struct decimal {
    /* 17 digits, padded by zeros; the first is not 0 */
    std::uint64_t digits;
    int point;
};

/* Converts a positive finite double. Thread-safe, about 10 ns. */
decimal shortest(double value);

} // namespace gd

#endif
