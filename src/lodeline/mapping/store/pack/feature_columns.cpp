#include "lodeline/mapping/store/pack/feature_columns.h"

#include <algorithm>
#include <array>
#include <limits>

#include "lodeline/mapping/store/pack/quantization.h"
#include "lodeline/mapping/store/pack/ray_functions.h"

namespace lodeline {
namespace {

using Cameras = std::array<RayFunctions, kMostCamerasOfMap>;
using Counts = std::array<size_t, kMostCamerasOfMap>;

/// All columns after the tracks, in the order of the file.
struct Columns {
  DirectionGrid grid{1024};
  DistanceScale scale{0.001};
  std::vector<uint8_t> kinds;        ///< bit c: the feature has a ray of camera c; bit 7: it has a point
  std::vector<uint8_t> first_sigma;  ///< packSigma of the first ray
  std::vector<uint16_t> first_u, first_v;  ///< place of the first ray's bearing on the grid
  std::vector<uint16_t> distance;          ///< along the first ray, of features with a point
  std::vector<uint8_t> across;             ///< packResidual of the point relative to the first ray
  std::vector<uint8_t> distance_sigma;
  std::vector<float> points;     ///< x y z where `across` is kNoResidual
  std::vector<uint8_t> further;  ///< packResidual of each further ray relative to the point
  std::vector<uint8_t> further_sigma;
  std::vector<uint16_t> further_u, further_v;  ///< place on the grid where `further` is kNoResidual
};

constexpr uint8_t kHasPoint = 0x80;

/// Differences of the numbers of successive tracks; 0 for a corner that was not tracked. Tracks usually rise,
/// so the differences are small.
std::vector<uint64_t> trackCodes(const std::vector<MapFeature>& features) {
  std::vector<uint64_t> codes;
  TrackId last = 0;
  for (const MapFeature& feature : features) {
    if (feature.track < 0) {
      codes.push_back(0);
      continue;
    }
    // 1, 3, 5, ... for 0, 1, 2, ... and 2, 4, 6, ... for -1, -2, -3, ...
    const TrackId difference = feature.track - last;
    codes.push_back(difference >= 0 ? 2 * static_cast<uint64_t>(difference) + 1
                                    : 2 * static_cast<uint64_t>(-difference));
    last = feature.track;
  }
  return codes;
}

void writeTracks(const std::vector<MapFeature>& features, ByteWriter* writer) {
  std::vector<uint64_t> codes = trackCodes(features);
  const auto first = std::find_if(codes.begin(), codes.end(), [](uint64_t code) { return code != 0; });
  // The first number is large, so it stands before the column.
  writer->integer(first != codes.end() ? *first : uint64_t{0});
  if (first != codes.end()) *first = 1;
  const uint64_t largest = codes.empty() ? 0 : *std::max_element(codes.begin(), codes.end());
  const auto write = [&]<typename Integer>(Integer) {
    writer->integer<uint8_t>(sizeof(Integer));
    writer->column(std::vector<Integer>(codes.begin(), codes.end()));
  };
  if (largest <= 0xffff)
    write(uint16_t{});
  else if (largest <= 0xffffffff)
    write(uint32_t{});
  else
    write(uint64_t{});
}

void readTracks(ByteReader* reader, std::vector<MapFeature>* features) {
  const auto first = reader->integer<uint64_t>();
  const auto width = reader->integer<uint8_t>();
  const auto read = [&]<typename Integer>(Integer) {
    bool is_first = true;
    uint64_t last = 0;
    const std::vector<Integer> codes = reader->column<Integer>(features->size());
    for (size_t i = 0; i < codes.size(); ++i) {
      if (codes[i] == 0) continue;
      const uint64_t code = is_first ? first : codes[i];
      is_first = false;
      last += code % 2 == 1 ? code / 2 : -(code / 2);
      if (last > static_cast<uint64_t>(std::numeric_limits<TrackId>::max()))
        throw InputError("the number of a track is out of range");
      (*features)[i].track = static_cast<TrackId>(last);
    }
  };
  if (width == 2)
    read(uint16_t{});
  else if (width == 4)
    read(uint32_t{});
  else if (width == 8)
    read(uint64_t{});
  else
    throw InputError("the numbers of tracks have an unknown width");
}

/// The coarsest grid that is fine enough for every ray, the coarsest scale for every distance.
void chooseSteps(const std::vector<MapFeature>& features, Columns* columns) {
  double least_sigma_rad = 1.0, least_relative = 1.0;
  for (const MapFeature& feature : features) {
    for (const BodyRay& ray : feature.rays) least_sigma_rad = std::min(least_sigma_rad, ray.sigma_rad);
    if (!feature.point_B) continue;
    const double distance_m = (*feature.point_B - feature.rays.front().origin_B).norm();
    least_relative = std::min(least_relative, feature.distance_sigma_m / std::max(distance_m, 1e-3));
  }
  columns->grid = DirectionGrid::forSigma(least_sigma_rad);
  columns->scale = DistanceScale::forSigma(least_relative);
}

Cameras functionsOf(const std::vector<MapFeature>& features) {
  std::array<std::vector<const BodyRay*>, kMostCamerasOfMap> rays;
  for (const MapFeature& feature : features) {
    for (const BodyRay& ray : feature.rays) rays[static_cast<size_t>(ray.camera)].push_back(&ray);
  }
  Cameras cameras;
  for (size_t i = 0; i < cameras.size(); ++i) cameras[i] = RayFunctions(rays[i]);
  return cameras;
}

/// Adds the point of a feature to the columns and returns it as it will be read.
Vec3 addPoint(const MapFeature& feature, const Vec3& origin_B, const Vec3& bearing_B, double sigma_rad,
              Columns* columns) {
  const Vec3 along = *feature.point_B - origin_B;
  const auto distance = columns->scale.pack(along.norm());
  const auto across = distance ? packResidual(along.normalized(), bearing_B, sigma_rad) : std::nullopt;
  columns->distance.push_back(across ? *distance : uint16_t{0});
  columns->across.push_back(across.value_or(kNoResidual));
  columns->distance_sigma.push_back(packSigma(feature.distance_sigma_m, kLeastDistanceSigma_m));
  if (across)
    return origin_B + columns->scale.unpack_m(*distance) * unpackResidual(*across, bearing_B, sigma_rad);
  for (const double coordinate : *feature.point_B) columns->points.push_back(static_cast<float>(coordinate));
  return feature.point_B->cast<float>().cast<double>();
}

void addFurtherRay(const BodyRay& ray, const std::optional<Vec3>& predicted, Columns* columns) {
  const uint8_t sigma = packSigma(ray.sigma_rad, kLeastRaySigma_rad);
  columns->further_sigma.push_back(sigma);
  const auto residual = predicted
                            ? packResidual(ray.bearing_B, *predicted, unpackSigma(sigma, kLeastRaySigma_rad))
                            : std::nullopt;
  columns->further.push_back(residual.value_or(kNoResidual));
  if (residual) return;
  const auto [u, v] = columns->grid.pack(ray.bearing_B);
  columns->further_u.push_back(u);
  columns->further_v.push_back(v);
}

Columns columnsOf(const std::vector<MapFeature>& features, const Cameras& cameras) {
  Columns columns;
  chooseSteps(features, &columns);
  Counts counts{};
  for (const MapFeature& feature : features) {
    const BodyRay& first = feature.rays.front();
    uint8_t kind = feature.point_B ? kHasPoint : 0;
    for (const BodyRay& ray : feature.rays) kind = static_cast<uint8_t>(kind | 1 << ray.camera);
    columns.kinds.push_back(kind);
    const auto [u, v] = columns.grid.pack(first.bearing_B);
    columns.first_u.push_back(u);
    columns.first_v.push_back(v);
    columns.first_sigma.push_back(packSigma(first.sigma_rad, kLeastRaySigma_rad));
    const auto camera = static_cast<size_t>(first.camera);
    const Vec3 bearing_B = columns.grid.unpack(u, v);
    const Vec3 origin_B = cameras[camera].origin_B(counts[camera], bearing_B);
    std::optional<Vec3> point_B;
    if (feature.point_B) {
      const double sigma_rad = unpackSigma(columns.first_sigma.back(), kLeastRaySigma_rad);
      point_B = addPoint(feature, origin_B, bearing_B, sigma_rad, &columns);
    }
    for (size_t i = 0; i < feature.rays.size(); ++i) {
      const BodyRay& ray = feature.rays[i];
      const size_t number = counts[static_cast<size_t>(ray.camera)]++;
      if (i == 0) continue;
      std::optional<Vec3> predicted;
      if (point_B) predicted = cameras[static_cast<size_t>(ray.camera)].predictedBearing(number, *point_B);
      addFurtherRay(ray, predicted, &columns);
    }
  }
  return columns;
}

}  // namespace

void writeColumns(const std::vector<MapFeature>& features, ByteWriter* writer) {
  writeTracks(features, writer);
  const Cameras cameras = functionsOf(features);
  const Columns columns = columnsOf(features, cameras);
  writer->column(columns.kinds);
  for (size_t i = 0; i < cameras.size(); ++i) {
    const bool is_used = std::any_of(columns.kinds.begin(), columns.kinds.end(),
                                     [&](uint8_t kind) { return (kind >> i & 1) != 0; });
    if (is_used) cameras[i].write(writer);
  }
  writer->integer(columns.grid.steps());
  writer->real32(columns.scale.step());
  writer->column(columns.first_u);
  writer->column(columns.first_v);
  writer->column(columns.first_sigma);
  writer->column(columns.distance);
  writer->column(columns.across);
  writer->column(columns.distance_sigma);
  for (const float coordinate : columns.points) writer->real32(coordinate);
  writer->column(columns.further);
  writer->column(columns.further_sigma);
  writer->column(columns.further_u);
  writer->column(columns.further_v);
}

namespace {

size_t countOf(const std::vector<uint8_t>& values, uint8_t wanted) {
  return static_cast<size_t>(std::count(values.begin(), values.end(), wanted));
}

/// Reads the functions of the cameras, and gives the features their rays, still without values.
Cameras readCameras(ByteReader* reader, const std::vector<uint8_t>& kinds,
                    std::vector<MapFeature>* features) {
  Counts counts{};
  for (size_t i = 0; i < kinds.size(); ++i) {
    if ((kinds[i] & ~kHasPoint) == 0) throw InputError("a feature has no ray");
    for (int camera = 0; camera < kMostCamerasOfMap; ++camera) {
      if ((kinds[i] >> camera & 1) == 0) continue;
      BodyRay ray;
      ray.camera = camera;
      (*features)[i].rays.push_back(ray);
      ++counts[static_cast<size_t>(camera)];
    }
  }
  Cameras cameras;
  for (size_t i = 0; i < cameras.size(); ++i) {
    if (counts[i] > 0) cameras[i] = RayFunctions::read(reader, counts[i]);
  }
  return cameras;
}

void readValues(ByteReader* reader, const std::vector<MapFeature>& features, Columns* all) {
  Columns& columns = *all;
  columns.grid = DirectionGrid(reader->integer<uint16_t>());
  columns.scale = DistanceScale(reader->real32());
  if (columns.grid.steps() == 0 || !(columns.scale.step() > 0.0 && columns.scale.step() < 1.0))
    throw InputError("the features have impossible steps");
  const size_t count = features.size();
  size_t further = 0;
  for (const MapFeature& feature : features) further += feature.rays.size() - 1;
  columns.first_u = reader->column<uint16_t>(count);
  columns.first_v = reader->column<uint16_t>(count);
  columns.first_sigma = reader->column<uint8_t>(count);
  const auto points = static_cast<size_t>(std::count_if(
      columns.kinds.begin(), columns.kinds.end(), [](uint8_t kind) { return (kind & kHasPoint) != 0; }));
  columns.distance = reader->column<uint16_t>(points);
  columns.across = reader->column<uint8_t>(points);
  columns.distance_sigma = reader->column<uint8_t>(points);
  for (size_t i = 0; i < 3 * countOf(columns.across, kNoResidual); ++i)
    columns.points.push_back(static_cast<float>(reader->real32()));
  columns.further = reader->column<uint8_t>(further);
  columns.further_sigma = reader->column<uint8_t>(further);
  columns.further_u = reader->column<uint16_t>(countOf(columns.further, kNoResidual));
  columns.further_v = reader->column<uint16_t>(countOf(columns.further, kNoResidual));
}

/// Fills features from columns, one after the other.
class FeatureFiller {
 public:
  FeatureFiller(const Columns& columns, const Cameras& cameras) : columns_(columns), cameras_(cameras) {}

  void fill(size_t number, MapFeature* feature) {
    BodyRay& first = feature->rays.front();
    first.bearing_B = columns_.grid.unpack(columns_.first_u[number], columns_.first_v[number]);
    first.sigma_rad = unpackSigma(columns_.first_sigma[number], kLeastRaySigma_rad);
    complete(&first);
    if ((columns_.kinds[number] & kHasPoint) != 0) fillPoint(feature);
    for (size_t i = 1; i < feature->rays.size(); ++i) fillFurther(feature->point_B, &feature->rays[i]);
  }

 private:
  void complete(BodyRay* ray) {
    const auto camera = static_cast<size_t>(ray->camera);
    const size_t number = counts_[camera]++;
    ray->origin_B = cameras_[camera].origin_B(number, ray->bearing_B);
    ray->pixel = cameras_[camera].pixel(number, ray->bearing_B);
  }

  void fillPoint(MapFeature* feature) {
    const BodyRay& first = feature->rays.front();
    const uint8_t across = columns_.across[point_];
    if (across != kNoResidual) {
      feature->point_B = first.origin_B + columns_.scale.unpack_m(columns_.distance[point_]) *
                                              unpackResidual(across, first.bearing_B, first.sigma_rad);
    } else {
      const float* point = columns_.points.data() + 3 * listed_point_++;
      feature->point_B = Vec3(point[0], point[1], point[2]);
    }
    if (!feature->point_B->allFinite()) throw InputError("the point of a feature is not finite");
    feature->distance_sigma_m = unpackSigma(columns_.distance_sigma[point_], kLeastDistanceSigma_m);
    ++point_;
  }

  void fillFurther(const std::optional<Vec3>& point_B, BodyRay* ray) {
    const auto camera = static_cast<size_t>(ray->camera);
    const uint8_t residual = columns_.further[further_];
    ray->sigma_rad = unpackSigma(columns_.further_sigma[further_], kLeastRaySigma_rad);
    ++further_;
    if (residual == kNoResidual) {
      ray->bearing_B = columns_.grid.unpack(columns_.further_u[listed_ray_], columns_.further_v[listed_ray_]);
      ++listed_ray_;
    } else {
      if (!point_B) throw InputError("a ray refers to a point that is missing");
      const Vec3 predicted = cameras_[camera].predictedBearing(counts_[camera], *point_B);
      ray->bearing_B = unpackResidual(residual, predicted, ray->sigma_rad);
    }
    complete(ray);
    if (!ray->bearing_B.allFinite()) throw InputError("a bearing is not finite");
  }

  const Columns& columns_;
  const Cameras& cameras_;
  Counts counts_{};
  size_t point_ = 0, listed_point_ = 0, further_ = 0, listed_ray_ = 0;
};

}  // namespace

void readColumns(ByteReader* reader, std::vector<MapFeature>* features) {
  readTracks(reader, features);
  Columns columns;
  columns.kinds = reader->column<uint8_t>(features->size());
  const Cameras cameras = readCameras(reader, columns.kinds, features);
  readValues(reader, *features, &columns);
  FeatureFiller filler(columns, cameras);
  for (size_t i = 0; i < features->size(); ++i) filler.fill(i, &(*features)[i]);
}

}  // namespace lodeline
