#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/rosbag/convert/bag_writer.h"
#include "lodeline/io/rosbag/convert/part_source.h"
#include "lodeline/recording.h"

namespace lodeline {

struct ConvertOptions {
  /// Files that describe the rig and, for bags, topics by sensor, as in BagOptions.
  std::vector<std::filesystem::path> rig_files;
  std::map<std::string, std::string> topics;
  /// Format of the new bag.
  BagFormat format = BagFormat::Ros1;
  /// Compression of the new bag; see makeBagWriter().
  std::string compression;
  /// Numbers of the cameras to convert; empty for all. The new recording numbers them from 0 on.
  std::vector<int> cameras;
  /// Readings outside of it are left out. From bag to bag, the times at which messages were recorded count.
  PartOfRecording part;
  /// Takes the share of the recording that is converted.
  std::function<void(double share)> progress = [](double) {};
};

struct ConvertSummary {
  std::map<std::string, int> readings;  ///< by sensor
  std::filesystem::path rig_file;       ///< written beside a new bag; empty otherwise
};

/// Converts a recording in the EuRoC ASL layout to a bag, with its calibration as NAME.rig.yaml beside it.
/// All readings keep their bits, stamps and order, except where the messages have a lower precision, which is
/// reported as `convert_rounded`. Sonar readings have 32 bits; depths become pressures, whose inverse is
/// exact to 1 nm. PNG images become Image messages with the same pixels. Other files become CompressedImage
/// messages with the same bytes. Of the true states, positions and attitudes are kept. Throws InputError
/// where the bag already exists or the recording cannot be read.
ConvertSummary convertFolderToBag(const std::filesystem::path& folder, const std::filesystem::path& bag,
                                  const ConvertOptions& options, Diagnostics* diagnostics);

/// Converts a bag to a recording in the EuRoC ASL layout. Without a rig file, the readings are written
/// without calibration, which is reported. Colour filter mosaics and YUV become grey because image files
/// cannot represent them. Throws InputError where the folder exists and is not empty, or the bag cannot be
/// read.
ConvertSummary convertBagToFolder(const std::filesystem::path& bag, const std::filesystem::path& folder,
                                  const ConvertOptions& options, Diagnostics* diagnostics);

/// Converts a recording in the EuRoC ASL layout to another folder, such as a part of it. Images and
/// calibration are copied, and so are the rows of other tables in mav0, such as true states. Throws
/// InputError where the target exists and is not empty, or the recording cannot be read.
ConvertSummary convertFolderToFolder(const std::filesystem::path& folder, const std::filesystem::path& target,
                                     const ConvertOptions& options, Diagnostics* diagnostics);

/// Converts a bag to a bag of any format. Topics, stamps and times of recording are kept. Between bags of ROS
/// 2, the messages of all types keep their bytes. Between ROS 1 and ROS 2, types that Lodeline reads are
/// converted, and other topics are left out (`convert_left_out`); sequence numbers of headers, which ROS 2
/// does not have, become 0. The rig files are written as one beside the new bag. Throws InputError where the
/// target exists or the bag cannot be read. Where cameras are chosen, topics of other images are left out.
ConvertSummary convertBagToBag(const std::filesystem::path& bag, const std::filesystem::path& target,
                               const ConvertOptions& options, Diagnostics* diagnostics);

/// Converts an open recording, such as a film, to the EuRoC ASL layout. `rig`: its calibration, which may be
/// empty. Throws InputError where the folder exists and is not empty.
ConvertSummary convertToFolder(RecordedSource* source, const RigFile& rig,
                               const std::filesystem::path& folder, const ConvertOptions& options,
                               Diagnostics* diagnostics);

/// Converts an open recording to a bag, with its calibration beside it. Throws InputError where the bag
/// exists.
ConvertSummary convertToBag(RecordedSource* source, const RigFile& rig, const std::filesystem::path& bag,
                            const ConvertOptions& options, Diagnostics* diagnostics);

/// Throws InputError where a bag or the rig file beside it exists.
void requireAbsent(const std::filesystem::path& bag);

/// Topic of the true poses in bags written by Lodeline.
inline constexpr const char* kTruthTopic = "/ground_truth/pose";

}  // namespace lodeline
