#pragma once

#include <ogrsf_frmts.h>

#include <functional>
#include <string>

/// Files that GDAL writes, in its memory.
namespace lodeline::gdal {

/// A file in GDAL's memory, which is removed at the end.
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& name) : path_("/vsimem/lodeline/" + name) {
    VSIUnlink(path_.c_str());
  }
  ~MemoryFile() { VSIUnlink(path_.c_str()); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const std::string& path() const { return path_; }
  /// Throws InputError where GDAL wrote nothing.
  std::string bytes() const;

 private:
  std::string path_;
};

/// Throws InputError with GDAL's last message.
void check(bool is_good, const char* what);

/// Dataset of one of GDAL's drivers in memory.
GDALDatasetUniquePtr createDataset(const char* driver_name, const MemoryFile& file);

/// Adds features to a table.
class Table {
 public:
  Table(GDALDataset* dataset, const char* name, OGRSpatialReference* grid, OGRwkbGeometryType type)
      : layer_(dataset->CreateLayer(name, grid, type, nullptr)) {
    check(layer_ != nullptr, name);
  }

  void addField(const char* name, OGRFieldType type) {
    OGRFieldDefn field(name, type);
    check(layer_->CreateField(&field) == OGRERR_NONE, name);
  }

  void add(const OGRGeometry& geometry, const std::function<void(OGRFeature&)>& fill) {
    const OGRFeatureUniquePtr feature(OGRFeature::CreateFeature(layer_->GetLayerDefn()));
    feature->SetGeometry(&geometry);
    fill(*feature);
    check(layer_->CreateFeature(feature.get()) == OGRERR_NONE, "a feature");
  }

 private:
  OGRLayer* layer_;
};

}  // namespace lodeline::gdal
