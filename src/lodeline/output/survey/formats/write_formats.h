#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lodeline/output/survey/map/dive_map.h"
#include "lodeline/sensors/rig.h"

/// One function a file format: the whole file as text (or bytes). Formats on the Earth (GeoJSON, KML, GPX)
/// need DiveMap::place.
namespace lodeline {

/// Survex data: the line as `*data cartesian`, which cavern takes for grid differences and never turns;
/// splays with grid bearings; passage sizes of the stations that have all four.
std::string survexText(const DiveMap& map);
/// One file that includes the files of several dives on one grid and equates those that begin at one place.
std::string survexProject(const std::vector<DiveMap>& maps, const std::string& title);

/// Therion data of the same survey, without its place. Therion turns cartesian data and bearings by the
/// convergence of the meridians at the fixed station: differences are given against true north.
std::string therionText(const DiveMap& map);
/// The place of the first station, in a file of its own: Therion refuses to equate two fixed stations.
std::string therionFix(const DiveMap& map);
/// Several dives as one survey; those that begin at one place are fixed once and equated.
std::string therionProject(const std::vector<DiveMap>& maps, const std::string& name,
                           const std::string& title);
/// A configuration for `therion` that makes model, survey list and KML from `sources`, named `name`.
std::string therionConfig(const DiveMap& map, const std::string& name,
                          const std::vector<std::string>& sources);

/// The dives that begin where an earlier one does, to a millimetre: pairs of names, the earlier first.
std::vector<std::pair<std::string, std::string>> equalStarts(const std::vector<DiveMap>& maps);

/// RFC 7946: longitude, latitude, height above the ellipsoid (WGS 84); line, stations, and the outline of the
/// passage from its widths.
std::string geojsonText(const DiveMap& map);

/// KML 2.2: the line once on the ground above and once at its height, stations with depth and size.
std::string kmlText(const DiveMap& map);

/// GPX 1.1: the way as a track, stations as waypoints.
std::string gpxText(const DiveMap& map);

/// Binary PLY in ENU, m: the way with edges and coloured by depth, then landmarks with normals that point at
/// the way.
std::string plyBytes(const DiveMap& map);

/// One line a pose, and one line a station. The first line is the header; what the map is made of stands in a
/// file of its own (export_owner.h), since GIS programs take comments for a header.
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

/// A COLMAP text model: three files.
struct ColmapModel {
  std::string cameras, images, points3D;
};
/// Landmarks come without observations, of which a run keeps only the number.
ColmapModel colmapModel(const DiveMap& map, const std::vector<CameraCalibration>& cameras,
                        const std::vector<ColmapImage>& images);

}  // namespace lodeline
