#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lodeline/output/survey/map/dive_map.h"
#include "lodeline/rig.h"

/// One function per file format, which returns the whole file as text (or bytes). Georeferenced formats
/// (GeoJSON, KML, GPX) need DiveMap::place.
namespace lodeline {

/// Survex data: the line as `*data cartesian`, which cavern interprets as grid differences without rotation;
/// splays with grid bearings; passage sizes of the stations that have all four.
std::string survexText(const DiveMap& map);
/// A file that includes the files of several dives on one grid and equates those with the same start.
std::string survexProject(const std::vector<DiveMap>& maps, const std::string& title);

/// Therion data of the same survey, without its position. Therion rotates cartesian data and bearings by the
/// meridian convergence at the fixed station, so differences are relative to true north.
std::string therionText(const DiveMap& map);
/// The position of the first station, in a separate file because Therion refuses to equate two fixed
/// stations.
std::string therionFix(const DiveMap& map);
/// Several dives as one survey; those with the same start are fixed once and equated.
std::string therionProject(const std::vector<DiveMap>& maps, const std::string& name,
                           const std::string& title);
/// A configuration for `therion` that creates model, survey list and KML from `sources`, named `name`.
std::string therionConfig(const DiveMap& map, const std::string& name,
                          const std::vector<std::string>& sources);

/// Pairs of dives with the same start, to a millimetre, by names, the earlier first.
std::vector<std::pair<std::string, std::string>> equalStarts(const std::vector<DiveMap>& maps);

/// RFC 7946: longitude, latitude, height above the ellipsoid (WGS 84); line, stations, and the outline of the
/// passage from its widths.
std::string geojsonText(const DiveMap& map);

/// Outline of the passage from its widths, one ring of four corners (ENU) between each two stations that have
/// them.
std::vector<std::vector<Vec3>> passagePlan(const Survey& survey);

/// Whether the library was built with GDAL, which writes the next two.
bool hasGdal();
/// OGC GeoPackage on the grid of the map, in its own unit, heights in metres: tables `line`, `stations`,
/// `passage`. Throws UsageError without GDAL.
std::string geopackageBytes(const DiveMap& map);
/// DXF on the grid of the map, in its own unit: layers LINE, STATIONS, NAMES and PASSAGE. Throws UsageError
/// without GDAL.
std::string dxfText(const DiveMap& map);

/// KML 2.2: the line once on the ground above and once at its height, stations with depth and size.
std::string kmlText(const DiveMap& map);

/// GPX 1.1: the path as a track, stations as waypoints.
std::string gpxText(const DiveMap& map);

/// Binary PLY in ENU, m: the path with edges and coloured by depth, then landmarks with normals that point
/// towards the path.
std::string plyBytes(const DiveMap& map);

/// One line per pose, and one line per station. The first line is the header. The notes on the map's origin
/// are in a separate file (export_owner.h), because GIS programs take comments for a header.
std::string posesCsv(const DiveMap& map);
std::string stationsCsv(const DiveMap& map);

/// The poses in ENU in TUM's layout.
std::string tumText(const DiveMap& map);

/// An image of a COLMAP model.
struct ColmapImage {
  size_t camera = 0;  ///< index
  size_t pose = 0;    ///< index in DiveMap::trajectory
  std::string name;
};

/// A camera as COLMAP describes it. Its pixel centres are at half-integers.
struct ColmapCamera {
  std::string model;  ///< such as OPENCV
  int width_px = 0, height_px = 0;
  std::vector<double> parameters;
  /// Why the camera is a fitted fisheye camera, and how much it deviates; empty where COLMAP has the model.
  std::string remark;
};
ColmapCamera colmapCamera(const CameraCalibration& camera);

/// The pose camera_from_map of an image.
Rigid3 colmapPose(const DiveMap& map, const std::vector<CameraCalibration>& cameras,
                  const ColmapImage& image);

/// A COLMAP text model: three files.
struct ColmapModel {
  std::string cameras, images, points3D;
};
/// Landmarks have no observations, because a run keeps only their number.
ColmapModel colmapModel(const DiveMap& map, const std::vector<CameraCalibration>& cameras,
                        const std::vector<ColmapImage>& images);

}  // namespace lodeline
