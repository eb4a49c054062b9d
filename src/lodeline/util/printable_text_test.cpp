#include "lodeline/util/printable_text.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

TEST(PrintableText, GoodTextStays) {
  for (const char* text :
       {"", "plain, with\ttab\nand line", "\u00b5T m/s\u00b2", "\u6d1e\u7a74", "\U0001F30A"}) {
    EXPECT_EQ(printableText(text), text);
  }
}

TEST(PrintableText, BytesThatAreNoTextAreShown) {
  EXPECT_EQ(printableText("14036\xf8,1"), "14036\\xF8,1");
  EXPECT_EQ(printableText("caf\xe9"), "caf\\xE9");
  EXPECT_EQ(printableText("cut \xe6\xb4"), "cut \\xE6\\xB4");
  EXPECT_EQ(printableText("overlong \xc0\xaf"), "overlong \\xC0\\xAF");
  EXPECT_EQ(printableText("surrogate \xed\xa0\x80"), "surrogate \\xED\\xA0\\x80");
  EXPECT_EQ(printableText(std::string("nul \0", 5)), "nul \\x00");
  EXPECT_EQ(printableText("\x1b[2J"), "\\x1B[2J");
}

}  // namespace
}  // namespace lodeline
