#include "apps/lodeline/shared/bag_options.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

namespace lodeline {

void addBagOptions(BagArguments* arguments, CLI::App* command) {
  command
      ->add_option("--rig", arguments->rig_files,
                   "calibration of the rig: rig.yaml, or files of Kalibr, OpenVINS, VINS-Fusion, ORB-SLAM3, "
                   "OKVIS, Basalt; "
                   "without it NAME.rig.yaml beside the bag, or what lies in the folder")
      ->type_name("FILE");
  command
      ->add_option(
          "--topic", arguments->topics,
          "for a bag: the topic of a sensor (cam0, imu0, mag0, dvl0 and so on); found by type where it "
          "is not named; imu0=/gyro,/accel unites two halves")
      ->type_name("SENSOR=TOPIC");
  command->add_flag(
      "--received-times", arguments->use_received_times,
      "for a bag whose header stamps are not filled: stamp messages with the times at which they "
      "were recorded, which are late and uneven");
}

}  // namespace lodeline
