#pragma once

#include <filesystem>
#include <string>

#include "simulation/dive/dive.h"
#include "simulation/sensors/sonar_model.h"

namespace lodeline {

// The streams of a vehicle into folders of `mav0`:
//   altimeter0/data.csv  #timestamp [ns],range [m]; readings without an echo are left out
//   dvl0/data.csv        one row for each beam of a ping; without lock 0.0 m/s, -2.0 m and valid 0
//   current0/data.csv    one column for each channel
void recordAltimeter(const Dive& dive, const RangeFunction& range, const std::filesystem::path& mav0);
void recordDvl(const Dive& dive, const RangeFunction& range, const std::filesystem::path& mav0);
void recordCurrents(const Dive& dive, const std::filesystem::path& mav0);

/// Errors of these sensors for truth/errors.yaml: scale and misalignment of the DVL, k_i of each channel.
std::string vehicleText(const Dive& dive);

/// Writes into folder/truth at 10 Hz, on the IMU's clock:
///   currents.csv     true current of each channel, A, and their field at the magnetometer, T in axes of its
///                    readings
///   dvl.csv          true velocity of the DVL in its true frame, m/s
///   steel.csv        dipoles of a wreck: position in W, m, and moment, A m^2
///   steel_field.csv  their field at the true poses, T in W
void recordVehicleTruth(const Dive& dive, const std::filesystem::path& truth);

}  // namespace lodeline
