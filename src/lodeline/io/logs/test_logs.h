#pragma once

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

// Writers of binary logs and zip archives, for tests. They follow the
// descriptions of the formats and share no code with the readers.

namespace lodeline::test {

template <typename Number>
std::string raw(Number number) {
  std::string bytes(sizeof(Number), '\0');
  std::memcpy(bytes.data(), &number, sizeof(Number));
  return bytes;
}

/// The bytes of several numbers in a row.
template <typename... Numbers>
std::string raws(Numbers... numbers) {
  return (raw(numbers) + ... + std::string());
}

/// A text in a field of a fixed size.
inline std::string padded(std::string_view text, size_t size) {
  std::string bytes(text);
  bytes.resize(size, '\0');
  return bytes;
}

/// Builds a ULog file.
class ULogBytes {
 public:
  ULogBytes() : bytes_(std::string("ULog\x01\x12\x35", 7) + '\1' + raw<uint64_t>(5'000'000)) {}

  ULogBytes& message(char type, const std::string& payload) {
    bytes_ += raw(static_cast<uint16_t>(payload.size())) + type + payload;
    return *this;
  }
  /// `offsets` of appended data; `flags`: incompatible ones.
  ULogBytes& flags(uint8_t flags, uint64_t offset = 0) {
    return message('B', std::string(8, '\0') + static_cast<char>(flags) + std::string(7, '\0') +
                            raws<uint64_t, uint64_t, uint64_t>(offset, 0, 0));
  }
  ULogBytes& format(const std::string& text) { return message('F', text); }
  ULogBytes& subscribe(uint16_t id, const std::string& topic, uint8_t instance = 0) {
    return message('A', raw(instance) + raw(id) + topic);
  }
  ULogBytes& data(uint16_t id, const std::string& payload) { return message('D', raw(id) + payload); }
  ULogBytes& sync() { return message('S', "\x2F\x73\x13\x20\x25\x0C\xBB\x12"); }
  ULogBytes& junk(const std::string& bytes) {
    bytes_ += bytes;
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Builds a DataFlash log. It begins with the definition of FMT itself, as
/// ArduPilot's do.
class DataFlashBytes {
 public:
  DataFlashBytes() { format(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns"); }

  DataFlashBytes& message(uint8_t type, const std::string& payload) {
    bytes_ += std::string("\xA3\x95") + static_cast<char>(type) + payload;
    return *this;
  }
  DataFlashBytes& format(uint8_t type, uint8_t length, const char* name, const char* codes,
                         const char* labels) {
    return message(128, raws(type, length) + padded(name, 4) + padded(codes, 16) + padded(labels, 64));
  }
  /// The tables of units and multipliers that ArduPilot writes.
  DataFlashBytes& units() {
    format(207, 76, "UNIT", "QbZ", "TimeUS,Id,Label");
    format(208, 20, "MULT", "Qbd", "TimeUS,Id,Mult");
    format(206, 44, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds");
    constexpr std::pair<char, const char*> kUnits[] = {{'s', "s"},     {'#', "instance"}, {'E', "rad/s"},
                                                       {'o', "m/s/s"}, {'G', "Gauss"},    {'P', "Pa"},
                                                       {'A', "A"},     {'k', "deg/s"},    {'?', "UNKNOWN"}};
    for (const auto& [id, unit] : kUnits) message(207, raws<uint64_t, char>(1, id) + padded(unit, 64));
    constexpr std::pair<char, double> kMultipliers[] = {{'-', 0.0},  {'?', 1.0},  {'0', 1.0},
                                                        {'C', 1e-3}, {'F', 1e-6}, {'B', 1e-2}};
    for (const auto& [id, number] : kMultipliers) message(208, raws<uint64_t, char, double>(1, id, number));
    return *this;
  }
  DataFlashBytes& unitsOf(uint8_t type, const char* units, const char* multipliers) {
    return message(206, raws<uint64_t, uint8_t>(1, type) + padded(units, 16) + padded(multipliers, 16));
  }
  DataFlashBytes& junk(const std::string& bytes) {
    bytes_ += bytes;
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Builds a zip archive.
class ZipBytes {
 public:
  ZipBytes& add(const std::string& name, const std::string& content, bool is_deflated = true) {
    const std::string packed = is_deflated ? deflated(content) : content;
    const auto check = static_cast<uint32_t>(
        crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size())));
    const std::string common = raws<uint16_t, uint16_t, uint16_t, uint32_t>(20, 0, is_deflated ? 8 : 0, 0) +
                               raws<uint32_t, uint32_t, uint32_t>(check, static_cast<uint32_t>(packed.size()),
                                                                  static_cast<uint32_t>(content.size())) +
                               raws<uint16_t, uint16_t>(static_cast<uint16_t>(name.size()), 0);
    const auto offset = static_cast<uint32_t>(bytes_.size());
    bytes_ += "PK\3\4" + common + name + packed;
    directory_ += "PK\1\2" + raw<uint16_t>(20) + common +
                  raws<uint16_t, uint16_t, uint16_t, uint32_t, uint32_t>(0, 0, 0, 0, offset) + name;
    ++count_;
    return *this;
  }
  std::string bytes() const {
    return bytes_ + directory_ + "PK\5\6" +
           raws<uint16_t, uint16_t, uint16_t, uint16_t, uint32_t, uint32_t, uint16_t>(
               0, 0, count_, count_, static_cast<uint32_t>(directory_.size()),
               static_cast<uint32_t>(bytes_.size()), 0);
  }

 private:
  static std::string deflated(const std::string& content) {
    z_stream stream = {};
    deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
    std::string packed(deflateBound(&stream, static_cast<uLong>(content.size())), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
    stream.avail_in = static_cast<uInt>(content.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
  }

  std::string bytes_, directory_;
  uint16_t count_ = 0;
};

}  // namespace lodeline::test
