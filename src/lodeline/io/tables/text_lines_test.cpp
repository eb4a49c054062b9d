#include "lodeline/io/tables/text_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <fstream>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> linesOf(const std::string& bytes) {
  TextLines lines(bytesInMemory(bytes), "table");
  std::vector<std::string> result;
  for (std::string_view line; lines.next(&line);) result.emplace_back(line);
  return result;
}

/// ASCII text as UTF-16, with the high byte first where `high_first`.
std::string utf16(const std::string& ascii, bool high_first) {
  std::string bytes;
  for (const char c : ascii) bytes += high_first ? std::string{'\0', c} : std::string{c, '\0'};
  return bytes;
}

TEST(TextLines, EndWithAnyLineEnd) {
  EXPECT_THAT(linesOf("a\nb\n"), ElementsAre("a", "b"));
  EXPECT_THAT(linesOf("a\r\nb\r\n\r\nc"), ElementsAre("a", "b", "", "c"));
  EXPECT_THAT(linesOf("a\rb\rc\r"), ElementsAre("a", "b", "c"));
  EXPECT_THAT(linesOf(""), ElementsAre());
}

TEST(TextLines, EndWithCrlfAcrossBlocks) {
  const std::string first((1 << 16) - 1, 'a');
  EXPECT_THAT(linesOf(first + "\r\nb"), ElementsAre(first, "b"));
}

TEST(TextLines, AreUtf8WhateverTheEncoding) {
  EXPECT_THAT(linesOf("\xEF\xBB\xBFt [s]\n1"), ElementsAre("t [s]", "1"));
  EXPECT_THAT(linesOf("\xFF\xFE" + utf16("t [s]\r\n1", false)), ElementsAre("t [s]", "1"));
  EXPECT_THAT(linesOf("\xFE\xFF" + utf16("t [s]\n1", true)), ElementsAre("t [s]", "1"));
  EXPECT_THAT(linesOf(utf16("t [s]\n1 2 3", false)), ElementsAre("t [s]", "1 2 3"));
  EXPECT_THAT(linesOf(utf16("t [s]\n1 2 3", true)), ElementsAre("t [s]", "1 2 3"));
  // Latin-1: a superscript 2 and the micro sign, beside a line in UTF-8.
  EXPECT_THAT(linesOf("m/s\xB2 \xB5T\nm/s\xC2\xB2"), ElementsAre("m/s\u00b2 \u00b5T", "m/s\u00b2"));
  // A surrogate pair and the same character in UTF-8.
  EXPECT_THAT(linesOf(std::string("\xFF\xFE\x3D\xD8\x00\xDE", 6)), ElementsAre("\U0001F600"));
}

TEST(TextLines, RefuseWhatIsNoText) {
  EXPECT_THROW(linesOf(std::string("\x7F\x45LF\0\0\0\0 and so on", 18)), InputError);
  EXPECT_THROW(linesOf("PK\x03\x04 a spreadsheet"), InputError);
  EXPECT_THROW(linesOf(std::string("\xFF\xFE\0\0t\0\0\0", 8)), InputError);
  // End of a log after a power failure.
  EXPECT_THAT(linesOf(std::string("1,2\n3,\0\0\0\0", 10)), ElementsAre("1,2", std::string("3,\0\0\0\0", 6)));
}

TEST(TextLines, KeepABoundedPartOfALongLine) {
  TextLines lines(bytesInMemory("1\n" + std::string(3 * TextLines::kLongestLine, '7') + "\n2"), "table");
  std::string_view line;
  ASSERT_TRUE(lines.next(&line));
  EXPECT_FALSE(lines.wasTooLong());
  ASSERT_TRUE(lines.next(&line));
  EXPECT_TRUE(lines.wasTooLong());
  EXPECT_EQ(line.size(), TextLines::kLongestLine);
  ASSERT_TRUE(lines.next(&line));
  EXPECT_EQ(line, "2");
  EXPECT_EQ(lines.number(), 3);
  EXPECT_TRUE(lines.hadNoEnd());
}

TEST(TextLines, OfACompressedFile) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "text_lines_test.gz";
  gzFile file = gzopen(path.c_str(), "wb");
  gzputs(file, "t,x\n1,2\n");
  gzclose(file);
  TextLines lines(openFile(path), path.string());
  std::string_view line;
  ASSERT_TRUE(lines.next(&line));
  EXPECT_EQ(line, "t,x");
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 9);
  const auto readAll = [&] {
    TextLines cut(openFile(path), path.string());
    for (std::string_view text; cut.next(&text);) {
    }
  };
  EXPECT_THROW(readAll(), InputError);
  std::filesystem::remove(path);
  EXPECT_THROW(openFile(path), InputError);
  EXPECT_THROW(openFile(testing::TempDir()), InputError);
}

TEST(Excerpt, IsShortAndPrintable) {
  EXPECT_EQ(excerpt("a\tb"), "a?b");
  EXPECT_EQ(excerpt(std::string(100, 'x')), std::string(60, 'x') + "...");
}

}  // namespace
}  // namespace lodeline
