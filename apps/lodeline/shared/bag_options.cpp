#include "apps/lodeline/shared/bag_options.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

namespace lodeline {

void addBagOptions(BagArguments* arguments, CLI::App* command) {
  command
      ->add_option("--rig", arguments->rig_files,
                   "calibration of the rig, also of another program; without it, NAME.rig.yaml beside the "
                   "bag, or what lies in the folder")
      ->type_name("FILE");
  command
      ->add_option("--topic", arguments->topics,
                   "topic of a sensor in a bag (cam0, imu0, mag0, dvl0 and so on); without it, found by "
                   "type; imu0=/gyro,/accel unites two topics")
      ->type_name("SENSOR=TOPIC");
  command->add_flag(
      "--received-times", arguments->use_received_times,
      "use the times at which messages were recorded, which are late and uneven, in place of header stamps");
}

}  // namespace lodeline
