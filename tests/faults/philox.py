"""Philox4x64-10 once more, from the paper (Salmon et al., SC 2011, section 3.3), to hold the random numbers against."""

MASK = 2**64 - 1
MULTIPLIERS = 0xD2E7470EE14C6C93, 0xCA5A826395121157
WEYL = 0x9E3779B97F4A7C15, 0xBB67AE8584CAA73B


def words(key, counter):
    """The four words of a counter."""
    x, k = list(counter), list(key)
    for _ in range(10):
        (high0, low0), (high1, low1) = (divmod(m * n, 2**64) for m, n in zip(MULTIPLIERS, x[::2], strict=True))
        x = [high1 ^ x[1] ^ k[0], low1, high0 ^ x[3] ^ k[1], low0]
        k = [(n + w) & MASK for n, w in zip(k, WEYL, strict=True)]
    return x


def uniform(seed, stream, lane, j):
    """Number j of a fault's stream, between 0 and 1."""
    return ((words((seed, 2**32 + stream), (0, j, lane, 0))[0] >> 11) + 0.5) * 2.0**-53
