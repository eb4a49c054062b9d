#pragma once

#include <functional>
#include <vector>

#include "lodeline/board/board_detector.h"
#include "lodeline/recording.h"

namespace lodeline {

/// The corners that one camera sees in one image.
struct BoardView {
  size_t camera = 0;
  std::vector<BoardCorner> corners;
};

/// The images of all cameras at one moment that show the board.
struct BoardFrame {
  Time stamp;  ///< on the camera's clock
  std::vector<BoardView> views;

  const BoardView* viewOf(size_t camera) const {
    for (const BoardView& view : views) {
      if (view.camera == camera) return &view;
    }
    return nullptr;
  }
};

/// A recording of a board.
struct BoardRecord {
  CalibrationBoard board;
  Rig rig;                         ///< as stated; the sizes of the images are always the measured ones
  std::vector<bool> has_lens;      ///< per camera: whether a file states its lens
  std::vector<BoardFrame> frames;  ///< by time
  std::vector<ImuSample> imu;
  std::vector<size_t> searched;  ///< number of images per camera
};

struct BoardRecordOptions {
  double most_rate_hz = 10.0;  ///< images used per second
  double from_s = 0.0;         ///< of the recording
  std::optional<double> to_s;
  std::function<void(size_t images)> progress = {};
};

/// Reads a recording and finds the board in its images. Images of several cameras within 2 ms are one frame.
/// Throws EstimationError where no camera sees the board, with what was looked for.
BoardRecord readBoardRecord(MeasurementSource* source, const CalibrationBoard& board,
                            const BoardRecordOptions& options, Diagnostics* diagnostics);

}  // namespace lodeline
