#include "lodeline/output/live/request_guard.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

TEST(RequestGuard, AddressesAndLocalhostAreServed) {
  for (const char* host : {"127.0.0.1", "127.0.0.1:8642", "192.168.1.20:8642", "localhost", "LocalHost:8642",
                           "[::1]", "[::1]:8642", "[fe80::1]:8642"}) {
    EXPECT_TRUE(isAddressOrLocalhost(host, "127.0.0.1")) << host;
  }
}

TEST(RequestGuard, NamesOfOthersAreNot) {
  for (const char* host : {"", ":8642", "evil.example", "evil.example:8642", "localhost.evil.example",
                           "127.0.0.1.evil.example", "[evil]", "[::1", "127.1:8642 evil"}) {
    EXPECT_FALSE(isAddressOrLocalhost(host, "127.0.0.1")) << host;
  }
}

TEST(RequestGuard, TheNameThatTheServerIsBoundToIsServed) {
  EXPECT_TRUE(isAddressOrLocalhost("rov.local:8642", "rov.local"));
  EXPECT_FALSE(isAddressOrLocalhost("rov.local:8642", "0.0.0.0"));
}

}  // namespace
}  // namespace lodeline
