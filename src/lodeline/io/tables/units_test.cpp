#include "lodeline/io/tables/units.h"

#include <gtest/gtest.h>

#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

double factorOf(const char* column, Quantity quantity) {
  return statedUnit(ColumnName(column), quantity).factor.value_or(0.0);
}

TEST(Units, StandInBracketsOrAtTheEndOfTheName) {
  EXPECT_DOUBLE_EQ(factorOf("wx [deg/s]", Quantity::AngularRate), kDegree);
  EXPECT_DOUBLE_EQ(factorOf("GYROSCOPE X (rad/s)", Quantity::AngularRate), 1.0);
  EXPECT_DOUBLE_EQ(factorOf("wx [rpm]", Quantity::AngularRate), 6.0 * kDegree);
  EXPECT_DOUBLE_EQ(factorOf("gyro_rad[0]", Quantity::AngularRate), 1.0);
  EXPECT_DOUBLE_EQ(factorOf("w_RS_S_x [rad s^-1]", Quantity::AngularRate), 1.0);
  EXPECT_DOUBLE_EQ(factorOf("a_RS_S_x [m s^-2]", Quantity::SpecificForce), 1.0);
  EXPECT_DOUBLE_EQ(factorOf("accelerometer_m_s2[2]", Quantity::SpecificForce), 1.0);
  EXPECT_DOUBLE_EQ(factorOf("ax (mg)", Quantity::SpecificForce), 9.80665e-3);
  EXPECT_DOUBLE_EQ(factorOf("mx [mG]", Quantity::MagneticField), 1e-7);
  EXPECT_DOUBLE_EQ(factorOf("magnetometer_ga[1]", Quantity::MagneticField), 1e-4);
  EXPECT_DOUBLE_EQ(factorOf("field_nT_x", Quantity::MagneticField), 1e-9);
  EXPECT_DOUBLE_EQ(factorOf("field_x", Quantity::MagneticField), 0.0);
  EXPECT_DOUBLE_EQ(factorOf("mag_x_nT", Quantity::MagneticField), 1e-9);
  EXPECT_DOUBLE_EQ(factorOf("Depth (ft)", Quantity::Length), 0.3048);
  EXPECT_DOUBLE_EQ(factorOf("depth_cm", Quantity::Length), 0.01);
  EXPECT_DOUBLE_EQ(factorOf("depth [dm]", Quantity::Length), 0.1);
  EXPECT_DOUBLE_EQ(factorOf("mx [Oe]", Quantity::MagneticField), 1e-4);  // in air
  EXPECT_NEAR(factorOf("mx [A/m]", Quantity::MagneticField), 1.2566e-6, 1e-10);
}

TEST(Units, AreReadInEveryNotationOfTheirSigns) {
  for (const char* force : {"ax (m/s\u00b2)", "ax (m/s^2)", "ax [m/s2]", "ax [m\u00b7s\u207b\u00b2]",
                            "ax (m/s\u00c2\u00b2)", "ax (m/s\ufffd)", "ax (m/s?)"}) {
    EXPECT_DOUBLE_EQ(factorOf(force, Quantity::SpecificForce), 1.0) << force;
  }
  EXPECT_DOUBLE_EQ(factorOf("wx (\u00b0/s)", Quantity::AngularRate), kDegree);
  EXPECT_DOUBLE_EQ(factorOf("wx (?/s)", Quantity::AngularRate), kDegree);
  for (const char* field : {"mx (\u00b5T)", "mx (\u03bcT)", "mx (uT)", "mx (\u00c2\u00b5T)"}) {
    EXPECT_DOUBLE_EQ(factorOf(field, Quantity::MagneticField), 1e-6) << field;
  }
}

TEST(Units, ThatAreNotKnownAreNamed) {
  EXPECT_TRUE(statedUnit(ColumnName("mx [furlong]"), Quantity::MagneticField).isUnknown());
  EXPECT_TRUE(statedUnit(ColumnName("mx (?T)"), Quantity::MagneticField).isUnknown());  // nT, uT or mT
  EXPECT_FALSE(statedUnit(ColumnName("MagX"), Quantity::MagneticField).isUnknown());
  EXPECT_FALSE(statedUnit(ColumnName("MagX"), Quantity::MagneticField).factor);
}

}  // namespace
}  // namespace lodeline
