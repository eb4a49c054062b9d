#pragma once

/// Attribute for a hot function: the compiler generates an AVX2 and a default version, and the program
/// selects one at start. Both versions do the same IEEE operations in the same order (AVX2 without fused
/// multiplication), so results do not depend on the selection. With LODELINE_PLAIN_VECTORS there is only the
/// default version, for the test that compares the two (studies/simd).
#if !defined(LODELINE_PLAIN_VECTORS) && defined(__x86_64__) && defined(__GNUC__) && \
    !defined(__SANITIZE_ADDRESS__)
#define LODELINE_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define LODELINE_WIDE_VECTORS
#endif
