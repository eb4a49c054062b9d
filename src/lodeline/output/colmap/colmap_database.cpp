#include "lodeline/output/colmap/colmap_database.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/store/sqlite/database.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

/// Numbers of the models of colmapCamera() (COLMAP 3.8, src/base/camera_models.h).
constexpr std::array<std::pair<std::string_view, int>, 5> kModelNumbers = {
    {{"PINHOLE", 1}, {"OPENCV", 4}, {"OPENCV_FISHEYE", 5}, {"FULL_OPENCV", 6}, {"FOV", 7}}};
constexpr int kCartesian = 1;  ///< PosePrior::CoordinateSystem::CARTESIAN

constexpr const char* kSchema = R"(
PRAGMA user_version = 3800;
CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, model INTEGER NOT NULL,
  width INTEGER NOT NULL, height INTEGER NOT NULL, params BLOB, prior_focal_length INTEGER NOT NULL);
CREATE TABLE images (image_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, name TEXT NOT NULL UNIQUE,
  camera_id INTEGER NOT NULL, prior_qw REAL, prior_qx REAL, prior_qy REAL, prior_qz REAL,
  prior_tx REAL, prior_ty REAL, prior_tz REAL,
  CONSTRAINT image_id_check CHECK(image_id >= 0 and image_id < 2147483647),
  FOREIGN KEY(camera_id) REFERENCES cameras(camera_id));
CREATE UNIQUE INDEX index_name ON images(name);
CREATE TABLE pose_priors (image_id INTEGER PRIMARY KEY NOT NULL, position BLOB,
  coordinate_system INTEGER NOT NULL, position_covariance BLOB,
  FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);
CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL,
  data BLOB, FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);
CREATE TABLE descriptors (image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL,
  data BLOB, FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);
CREATE TABLE matches (pair_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL,
  data BLOB);
CREATE TABLE two_view_geometries (pair_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL,
  cols INTEGER NOT NULL, data BLOB, config INTEGER NOT NULL, F BLOB, E BLOB, H BLOB, qvec BLOB, tvec BLOB);
)";

int modelNumber(const std::string& name) {
  const auto* found = std::find_if(kModelNumbers.begin(), kModelNumbers.end(),
                                   [&](const auto& model) { return model.first == name; });
  if (found == kModelNumbers.end()) throw std::logic_error("no number of the COLMAP model " + name);
  return found->second;
}

std::span<const unsigned char> bytesOf(const double* numbers, size_t count) {
  return {reinterpret_cast<const unsigned char*>(numbers), count * sizeof(double)};
}

/// Reported covariance of a position, m^2; null where the run has none.
const Mat3* covarianceAt(const DiveMap& map, Time time) {
  const auto found = std::lower_bound(map.uncertainties.begin(), map.uncertainties.end(), time,
                                      [](const PositionUncertainty& u, Time t) { return u.time < t; });
  return found != map.uncertainties.end() && found->time == time ? &found->covariance : nullptr;
}

void addImage(const DiveMap& map, const MapImages& images, size_t index, Database* database) {
  const ColmapImage& image = images.images[index];
  const auto id = static_cast<int64_t>(index + 1);
  const Rigid3 camera_from_map = colmapPose(map, images.cameras, image);
  const Quat q = so3::canonical(camera_from_map.rotation);
  const Vec3 centre = camera_from_map.inverse().translation;
  database->query("INSERT INTO images VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .integer(id)
      .text(image.name)
      .integer(static_cast<int64_t>(image.camera + 1))
      .real(q.w())
      .real(q.x())
      .real(q.y())
      .real(q.z())
      .real(centre.x())
      .real(centre.y())
      .real(centre.z())
      .run();
  const Mat3* covariance = covarianceAt(map, map.trajectory.poses.at(image.pose).time);
  Query prior = database->query("INSERT INTO pose_priors VALUES (?, ?, ?, ?)");
  prior.integer(id).blob(bytesOf(centre.data(), 3)).integer(kCartesian);
  covariance ? prior.blob(bytesOf(covariance->data(), 9)) : prior.null();
  prior.run();
}

}  // namespace

void writeColmapDatabase(const DiveMap& map, const std::optional<MapImages>& images,
                         const std::filesystem::path& file, Diagnostics* diagnostics) {
  if (!images || images->images.empty()) {
    throw UsageError(file.string() + ": no image has a pose; name the run's recording with --recording DATA");
  }
  createOutputFolder(file.parent_path());
  for (const char* ending : {"", "-wal", "-shm", "-journal"}) std::filesystem::remove(file.string() + ending);
  Database database(file, Database::Mode::Create);
  database.run("BEGIN");
  database.run(kSchema);
  for (size_t i = 0; i < images->cameras.size(); ++i) {
    const ColmapCamera camera = colmapCamera(images->cameras[i]);
    if (!camera.remark.empty()) diagnostics->report(Severity::Warning, "colmap_camera_fitted", camera.remark);
    database.query("INSERT INTO cameras VALUES (?, ?, ?, ?, ?, 1)")
        .integer(static_cast<int64_t>(i + 1))
        .integer(modelNumber(camera.model))
        .integer(camera.width_px)
        .integer(camera.height_px)
        .blob(bytesOf(camera.parameters.data(), camera.parameters.size()))
        .run();
  }
  for (size_t i = 0; i < images->images.size(); ++i) addImage(map, *images, i, &database);
  database.run("COMMIT");
}

}  // namespace lodeline
