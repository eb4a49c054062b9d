#include "lodeline/io/csv/sensor_columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/io/tables/cells.h"

namespace lodeline {
namespace {

using ::testing::ElementsAre;

/// The columns of a header with commas.
SensorColumns find(const std::string& header) {
  std::vector<std::string_view> cells;
  std::vector<std::string> unquoted;
  splitCells(header, Separator::Comma, &cells, &unquoted);
  return findSensorColumns({cells.begin(), cells.end()});
}

std::vector<std::size_t> columnsOf(const std::optional<TriadColumns>& triad) {
  return triad ? std::vector<std::size_t>(triad->column.begin(), triad->column.end())
               : std::vector<std::size_t>();
}

struct Layout {
  const char* what;
  const char* header;
  std::vector<std::size_t> rate, force, field;
  std::size_t time;
};

TEST(SensorColumns, AreFoundInTheHeadersOfManyPrograms) {
  const std::vector<std::size_t> none;
  const std::vector<Layout> layouts = {
      {"EuRoC",
       "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],"
       "a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]",
       {1, 2, 3},
       {4, 5, 6},
       none,
       0},
      {"accelerometer first", "time,ax,ay,az,gx,gy,gz", {4, 5, 6}, {1, 2, 3}, none, 0},
      {"ArduPilot IMU",
       "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH",
       {2, 3, 4},
       {5, 6, 7},
       none,
       0},
      {"ArduPilot MAG",
       "timestamp,TimeUS,I,MagX,MagY,MagZ,OfsX,OfsY,OfsZ,MOX,MOY,MOZ,Health,S",
       none,
       none,
       {3, 4, 5},
       0},
      {"PX4 sensor_combined",
       "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],gyro_integral_dt,accelerometer_timestamp_relative,"
       "accelerometer_m_s2[0],accelerometer_m_s2[1],accelerometer_m_s2[2],accelerometer_integral_dt",
       {1, 2, 3},
       {6, 7, 8},
       none,
       0},
      {"PX4 vehicle_magnetometer",
       "timestamp,timestamp_sample,device_id,magnetometer_ga[0],magnetometer_ga[1],magnetometer_ga[2]",
       none,
       none,
       {3, 4, 5},
       0},
      {"rostopic",
       "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.orientation.x,field."
       "orientation.y,"
       "field.orientation.z,field.orientation.w,field.angular_velocity.x,field.angular_velocity.y,"
       "field.angular_velocity.z,field.linear_acceleration.x,field.linear_acceleration.y,"
       "field.linear_acceleration.z",
       {8, 9, 10},
       {11, 12, 13},
       none,
       2},
      {"bagpy",
       "Time,header.seq,header.stamp.secs,header.stamp.nsecs,header.frame_id,magnetic_field.x,magnetic_field."
       "y,"
       "magnetic_field.z,magnetic_field_covariance_0",
       none,
       none,
       {5, 6, 7},
       2},
      {"AndroSensor",
       "ACCELEROMETER X (m/s\u00b2),ACCELEROMETER Y (m/s\u00b2),ACCELEROMETER Z (m/s\u00b2),GYROSCOPE X "
       "(rad/s),"
       "GYROSCOPE Y (rad/s),GYROSCOPE Z (rad/s),MAGNETIC FIELD X (\u03bcT),MAGNETIC FIELD Y (\u03bcT),"
       "MAGNETIC FIELD Z (\u03bcT),Time since start in ms ",
       {3, 4, 5},
       {0, 1, 2},
       {6, 7, 8},
       9},
      {"SensorConnect",
       "GPS TFlags,GPS Week,GPS TOW,X Accel [x8004],Y Accel [x8004],Z Accel [x8004],X Gyro [x8005],Y Gyro "
       "[x8005],"
       "Z Gyro [x8005],X Mag [x8006],Y Mag [x8006],Z Mag [x8006]",
       {6, 7, 8},
       {3, 4, 5},
       {9, 10, 11},
       2},
      {"Xsens",
       "PacketCounter,SampleTimeFine,Acc_X,Acc_Y,Acc_Z,FreeAcc_E,FreeAcc_N,FreeAcc_U,Gyr_X,Gyr_Y,Gyr_Z,Mag_X,"
       "Mag_Y,"
       "Mag_Z,Quat_q0,Quat_q1,Quat_q2,Quat_q3",
       {8, 9, 10},
       {2, 3, 4},
       {11, 12, 13},
       1},
      {"VectorNav",
       "Time,Yaw,Pitch,Roll,MagX,MagY,MagZ,AccelX,AccelY,AccelZ,GyroX,GyroY,GyroZ",
       {10, 11, 12},
       {7, 8, 9},
       {4, 5, 6},
       0},
      {"ADIS", "t [s],x_gyro,y_gyro,z_gyro,x_accl,y_accl,z_accl", {1, 2, 3}, {4, 5, 6}, none, 0},
      {"SensorLog",
       "loggingTime(txt),motionTimestamp_sinceReboot(s),motionRotationRateX(rad/s),motionRotationRateY(rad/"
       "s),"
       "motionRotationRateZ(rad/s),motionUserAccelerationX(G),motionUserAccelerationY(G),"
       "motionUserAccelerationZ(G),motionGravityX(G),motionGravityY(G),motionGravityZ(G),"
       "accelerometerAccelerationX(G),accelerometerAccelerationY(G),accelerometerAccelerationZ(G),"
       "magnetometerX(\u00b5T),magnetometerY(\u00b5T),magnetometerZ(\u00b5T)",
       {2, 3, 4},
       {11, 12, 13},
       {14, 15, 16},
       1},
      {"phyphox, German",
       "Zeit (s),Magnetfeld x (\u00b5T),Magnetfeld y (\u00b5T),Magnetfeld z (\u00b5T)",
       none,
       none,
       {1, 2, 3},
       0},
      {"phyphox, French",
       "Temps (s),Champ magn\u00e9tique x (\u00b5T),Champ magn\u00e9tique y (\u00b5T),"
       "Champ magn\u00e9tique z (\u00b5T)",
       none,
       none,
       {1, 2, 3},
       0},
      {"phyphox, Polish",
       "Czas (s),Przyspieszenie x (m/s^2),Przyspieszenie y (m/s^2),Przyspieszenie z (m/s^2)",
       none,
       {1, 2, 3},
       none,
       0},
      {"by units", "X (\u00b5T),Y (\u00b5T),Z (\u00b5T),t (s)", none, none, {0, 1, 2}, 3},
      {"Physics Toolbox", "time,gFx,gFy,gFz,wx,wy,wz,Bx,By,Bz", {4, 5, 6}, {1, 2, 3}, {7, 8, 9}, 0},
  };
  for (const Layout& layout : layouts) {
    const SensorColumns found = find(layout.header);
    EXPECT_EQ(columnsOf(found.angular_rate), layout.rate) << layout.what;
    EXPECT_EQ(columnsOf(found.specific_force), layout.force) << layout.what;
    EXPECT_EQ(columnsOf(found.field), layout.field) << layout.what;
    ASSERT_FALSE(found.times.empty()) << layout.what;
    EXPECT_EQ(found.times.front().column, layout.time) << layout.what;
    EXPECT_FALSE(found.unnamed) << layout.what;
  }
}

TEST(SensorColumns, LeaveOutWhatIsNoReading) {
  const SensorColumns biases =
      find("t,b_w_x,b_w_y,b_w_z,b_a_x,b_a_y,b_a_z,gyro_bias_x,gyro_bias_y,gyro_bias_z");
  EXPECT_FALSE(biases.angular_rate || biases.specific_force || biases.field);
  EXPECT_FALSE(find("t,gx,gy,ax,ay").angular_rate);
  EXPECT_FALSE(find("t,rotation x (deg),rotation y (deg),rotation z (deg)").angular_rate);
}

TEST(SensorColumns, KeepTriadsTogetherAndNameTheOthers) {
  const SensorColumns two = find("t,mag1_x,mag2_x,mag1_y,mag2_y,mag1_z,mag2_z");
  EXPECT_EQ(columnsOf(two.field), (std::vector<std::size_t>{1, 3, 5}));
  EXPECT_THAT(two.unused, ElementsAre("mag2_x, mag2_y, mag2_z"));
}

TEST(SensorColumns, KnowThatTheFieldOfXsensHasNoUnit) {
  EXPECT_TRUE(find("PacketCounter,SampleTimeFine,Acc_X,Acc_Y,Acc_Z,Mag_X,Mag_Y,Mag_Z").has_relative_field);
  EXPECT_FALSE(find("t,mag_x,mag_y,mag_z").has_relative_field);
}

TEST(SensorColumns, KnowPartsOfTimesAndInstances) {
  const TimeColumn stamp = find("Time,header.stamp.secs,header.stamp.nsecs,mx,my,mz").times.front();
  EXPECT_EQ(stamp.column, 1u);
  EXPECT_EQ(stamp.second, 2u);
  EXPECT_EQ(find("TimeUS,I,MagX,MagY,MagZ").instance, 1u);
  EXPECT_EQ(find("t [fortnight],mx,my,mz").times.front().unknown_unit, "fortnight");
  const SensorColumns bare = find("time,seconds_elapsed,z,y,x");
  EXPECT_EQ(columnsOf(bare.unnamed), (std::vector<std::size_t>{4, 3, 2}));
  EXPECT_EQ(bare.times.front().column, 0u);
}

}  // namespace
}  // namespace lodeline
