#pragma once

/// Before a hot function: compiles it twice, the machine picks at start. Both versions do the same IEEE
/// operations in the same order (AVX2 without fused multiplication), so results do not depend on the choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__)
#define LODELINE_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define LODELINE_WIDE_VECTORS
#endif
