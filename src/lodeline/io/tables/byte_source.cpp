#include "lodeline/io/tables/byte_source.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

class FileBytes : public ByteSource {
 public:
  explicit FileBytes(const std::filesystem::path& file)
      : name_(file.string()), file_(gzopen(file.c_str(), "rb"), gzclose) {
    if (!file_) throw InputError(name_ + ": cannot be opened for reading");
    gzbuffer(file_.get(), 1 << 17);
  }

  std::size_t read(char* into, std::size_t size) override {
    // zlib returns files without its own header unchanged.
    const int count = gzread(file_.get(), into, static_cast<unsigned>(std::min<std::size_t>(size, 1 << 20)));
    int status = Z_OK;
    const char* reason = gzerror(file_.get(), &status);
    if (count < 0 || (count == 0 && status != Z_OK && status != Z_STREAM_END)) {
      throw InputError(fmt::format("{}: cannot be read ({}); the file is damaged or cut off", name_, reason));
    }
    return static_cast<std::size_t>(count);
  }

 private:
  std::string name_;
  std::unique_ptr<gzFile_s, int (*)(gzFile)> file_;
};

class MemoryBytes : public ByteSource {
 public:
  explicit MemoryBytes(std::string bytes) : bytes_(std::move(bytes)) {}

  std::size_t read(char* into, std::size_t size) override {
    const std::size_t count = bytes_.copy(into, size, position_);
    position_ += count;
    return count;
  }

 private:
  std::string bytes_;
  std::size_t position_ = 0;
};

/// A stream of the bytes read to recognize the encoding, followed by the rest.
class Rejoined : public ByteSource {
 public:
  Rejoined(std::string head, std::unique_ptr<ByteSource> rest)
      : head_(std::move(head)), rest_(std::move(rest)) {}

  std::size_t read(char* into, std::size_t size) override {
    if (position_ == head_.size()) return rest_->read(into, size);
    const std::size_t count = head_.copy(into, size, position_);
    position_ += count;
    return count;
  }

 private:
  std::string head_;
  std::size_t position_ = 0;
  std::unique_ptr<ByteSource> rest_;
};

void appendUtf8(uint32_t code, std::string* text) {
  const auto put = [text](uint32_t byte) { text->push_back(static_cast<char>(byte)); };
  if (code < 0x80) {
    put(code);
  } else if (code < 0x800) {
    put(0xC0 | code >> 6);
    put(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    put(0xE0 | code >> 12);
    put(0x80 | (code >> 6 & 0x3F));
    put(0x80 | (code & 0x3F));
  } else {
    put(0xF0 | code >> 18);
    put(0x80 | (code >> 12 & 0x3F));
    put(0x80 | (code >> 6 & 0x3F));
    put(0x80 | (code & 0x3F));
  }
}

class FromUtf16 : public ByteSource {
 public:
  FromUtf16(std::unique_ptr<ByteSource> bytes, bool high_byte_first)
      : bytes_(std::move(bytes)), high_byte_first_(high_byte_first) {}

  std::size_t read(char* into, std::size_t size) override {
    while (position_ == text_.size()) {
      text_.clear();
      position_ = 0;
      if (!convertMore()) return 0;
    }
    const std::size_t count = text_.copy(into, size, position_);
    position_ += count;
    return count;
  }

 private:
  bool convertMore() {
    char buffer[8192];
    const std::size_t count = bytes_->read(buffer, sizeof(buffer));
    for (std::size_t i = 0; i < count; ++i) {
      const auto byte = static_cast<unsigned char>(buffer[i]);
      if (!has_first_byte_) {
        first_byte_ = byte;
      } else {
        addUnit(high_byte_first_ ? first_byte_ << 8 | byte : byte << 8 | first_byte_);
      }
      has_first_byte_ = !has_first_byte_;
    }
    return count > 0;
  }

  void addUnit(uint32_t unit) {
    const uint32_t high = std::exchange(high_surrogate_, 0);
    if (unit >= 0xD800 && unit < 0xDC00) {
      high_surrogate_ = unit;
    } else if (unit >= 0xDC00 && unit < 0xE000) {
      appendUtf8(high != 0 ? 0x10000 + ((high - 0xD800) << 10) + (unit - 0xDC00) : 0xFFFD, &text_);
    } else {
      appendUtf8(unit, &text_);
    }
  }

  std::unique_ptr<ByteSource> bytes_;
  bool high_byte_first_;
  bool has_first_byte_ = false;
  uint32_t first_byte_ = 0;
  uint32_t high_surrogate_ = 0;
  std::string text_;
  std::size_t position_ = 0;
};

/// Whether nearly every pair of bytes has a zero at `zero_at` (0 or 1), as Latin letters in UTF-16 have.
bool looksLikeUtf16(std::string_view head, std::size_t zero_at) {
  std::size_t zeros = 0, others = 0;
  const std::size_t pairs = head.size() / 2;
  for (std::size_t i = 0; i < pairs; ++i) {
    zeros += head[2 * i + zero_at] == '\0' ? 1 : 0;
    others += head[2 * i + 1 - zero_at] == '\0' ? 1 : 0;
  }
  return pairs >= 4 && others == 0 && 10 * zeros >= 9 * pairs;
}

std::string readHead(ByteSource* bytes) {
  std::string head(4096, '\0');
  std::size_t filled = 0;
  while (filled < head.size()) {
    const std::size_t count = bytes->read(head.data() + filled, head.size() - filled);
    if (count == 0) break;
    filled += count;
  }
  head.resize(filled);
  return head;
}

/// Throws InputError where a zero byte precedes the end of the first line. Later zeros are accepted, because
/// a log may end in zeros after a power failure.
void requireText(std::string_view head, const std::string& name) {
  if (head.starts_with("PK\x03\x04")) {
    throw InputError(
        name + ": is a zip archive (as spreadsheets in .xlsx and .ods are), expected text; save it as CSV");
  }
  const std::size_t zero = head.find('\0');
  if (zero == std::string_view::npos ||
      head.substr(0, zero).find_first_of("\r\n") != std::string_view::npos) {
    return;
  }
  throw InputError(name + ": is no text (it holds zero bytes); expected a table in UTF-8, UTF-16 or Latin-1");
}

}  // namespace

std::unique_ptr<ByteSource> openFile(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) throw InputError(file.string() + ": no such file");
  if (std::filesystem::is_directory(file, ignored)) {
    throw InputError(file.string() + ": is a folder, expected a file");
  }
  return std::make_unique<FileBytes>(file);
}

std::unique_ptr<ByteSource> bytesInMemory(std::string bytes) {
  return std::make_unique<MemoryBytes>(std::move(bytes));
}

std::unique_ptr<ByteSource> inUtf8(std::unique_ptr<ByteSource> bytes, const std::string& name) {
  std::string head = readHead(bytes.get());
  const std::string_view view = head;
  const auto rejoin = [&](std::size_t mark) {
    return std::make_unique<Rejoined>(head.substr(mark), std::move(bytes));
  };
  if (view.starts_with(std::string_view("\xFF\xFE\0\0", 4)) ||
      view.starts_with(std::string_view("\0\0\xFE\xFF", 4))) {
    throw InputError(name + ": is text in UTF-32; save it as UTF-8");
  }
  if (view.starts_with("\xFF\xFE")) return std::make_unique<FromUtf16>(rejoin(2), false);
  if (view.starts_with("\xFE\xFF")) return std::make_unique<FromUtf16>(rejoin(2), true);
  if (looksLikeUtf16(view, 1)) return std::make_unique<FromUtf16>(rejoin(0), false);
  if (looksLikeUtf16(view, 0)) return std::make_unique<FromUtf16>(rejoin(0), true);
  requireText(view, name);
  return rejoin(view.starts_with("\xEF\xBB\xBF") ? 3 : 0);
}

}  // namespace lodeline
