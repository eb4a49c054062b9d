#include "lodeline/io/logs/binary/dataflash.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/logs/test_logs.h"

namespace lodeline {
namespace {

using test::raws;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

DataFlash openBin(const std::string& bytes) { return DataFlash(bytesInMemory(bytes), "a.BIN"); }

struct BinValue {
  double number = 0.0;
  std::string unit;
  int instance = 0;
};

std::vector<BinValue> binValuesOf(DataFlash* log, const std::string& topic, const std::string& field) {
  std::vector<BinValue> values;
  for (LogMessage message; log->next(&message);) {
    if (message.format->topic != topic) continue;
    const LogField* found = message.format->field(field);
    values.push_back({found == nullptr ? -1.0 : message.value(*found).value_or(-2.0),
                      found == nullptr ? "" : found->unit, message.instance});
  }
  return values;
}

std::vector<double> numbersOf(const std::string& bytes, const std::string& field) {
  DataFlash log = openBin(bytes);
  std::vector<double> numbers;
  for (const BinValue& value : binValuesOf(&log, "TST", field)) numbers.push_back(value.number);
  return numbers;
}

/// A log with a type of one number a message.
test::DataFlashBytes begunBin() {
  test::DataFlashBytes log;
  log.format(10, 15, "TST", "Qf", "TimeUS,V");
  return log;
}
std::string binNumber(float value) { return raws<uint64_t, float>(1000, value); }

TEST(DataFlash, ReadsNumbersOfEveryCode) {
  test::DataFlashBytes log;
  log.format(10, 3 + 1 + 1 + 2 + 2 + 4 + 4 + 4 + 8 + 4 + 2 + 2 + 4 + 4 + 4 + 1, "TST", "bBhHiIfdncCeELM",
             "a,b,c,d,e,f,g,h,n,i,j,k,l,m,o");
  log.message(10, raws<int8_t, uint8_t, int16_t, uint16_t, int32_t>(-2, 250, -300, 60000, -70000) +
                      raws<uint32_t, float, double>(4000000000U, 0.5F, 0.25) + "text" +
                      raws<int16_t, uint16_t, int32_t, uint32_t>(-150, 250, -12345, 54321) +
                      raws<int32_t, uint8_t>(298300000, 5));
  const std::pair<const char*, double> expected[] = {
      {"a", -2},   {"b", 250},  {"c", -300}, {"d", 60000},   {"e", -70000}, {"f", 4e9},   {"g", 0.5},
      {"h", 0.25}, {"i", -1.5}, {"j", 2.5},  {"k", -123.45}, {"l", 543.21}, {"m", 29.83}, {"o", 5}};
  for (const auto& [name, value] : expected)
    EXPECT_THAT(numbersOf(log.bytes(), name), ElementsAre(DoubleNear(value, 1e-9))) << name;
}

TEST(DataFlash, AppliesTheUnitsAndMultipliersOfTheLog) {
  test::DataFlashBytes log;
  log.units().format(10, 3 + 8 + 1 + 2 + 2, "TST", "QBhc", "TimeUS,I,Mag,Tmp").unitsOf(10, "s#G?", "F-CB");
  log.message(10, raws<uint64_t, uint8_t, int16_t, int16_t>(1000, 2, -345, 1250));
  DataFlash field = openBin(log.bytes());
  const std::vector<BinValue> values = binValuesOf(&field, "TST", "Mag");
  ASSERT_EQ(values.size(), 1U);
  EXPECT_NEAR(values[0].number, -0.345, 1e-12);
  EXPECT_EQ(values[0].unit, "Gauss");
  EXPECT_EQ(values[0].instance, 2);
  // The multiplier of the log replaces that of the code: 12.50 and not 0.1250.
  EXPECT_THAT(numbersOf(log.bytes(), "Tmp"), ElementsAre(DoubleNear(12.5, 1e-12)));
}

TEST(DataFlash, ContinuesAfterDamage) {
  test::DataFlashBytes log = begunBin();
  log.message(10, binNumber(1)).junk(std::string("\xA3\x95\x63", 3) + "zeros" + std::string(40, '\0'));
  log.message(10, binNumber(2));
  DataFlash dataflash = openBin(log.bytes());
  const std::vector<BinValue> values = binValuesOf(&dataflash, "TST", "V");
  ASSERT_EQ(values.size(), 2U);
  EXPECT_EQ(values[1].number, 2);
  EXPECT_EQ(dataflash.damage().places, 1);
  EXPECT_EQ(dataflash.damage().bytes, 48U);
}

TEST(DataFlash, TellsWhereItIsCutOff) {
  test::DataFlashBytes log = begunBin();
  log.message(10, binNumber(1)).message(10, binNumber(2));
  for (size_t cut = 1; cut < 15; ++cut) {
    DataFlash dataflash = openBin(log.bytes().substr(0, log.bytes().size() - cut));
    EXPECT_EQ(binValuesOf(&dataflash, "TST", "V").size(), 1U) << cut;
    EXPECT_TRUE(dataflash.damage().is_cut_off) << cut;
  }
}

TEST(DataFlash, PassesOverDefinitionsWithAWrongLength) {
  test::DataFlashBytes log = begunBin();
  log.format(10, 14, "TST", "Qf", "TimeUS,V")
      .format(11, 9, "BAD", "Q?", "TimeUS,V")
      .message(10, binNumber(7));
  EXPECT_THAT(numbersOf(log.bytes(), "V"), ElementsAre(7));
}

TEST(DataFlash, RefusesOtherFiles) {
  EXPECT_THAT([] { openBin("nothing"); }, ThrowsMessage<InputError>(HasSubstr("DataFlash")));
}

}  // namespace
}  // namespace lodeline
