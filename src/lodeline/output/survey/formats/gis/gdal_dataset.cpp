#include "lodeline/output/survey/formats/gis/gdal_dataset.h"

#include <fmt/format.h>

#include <mutex>

#include "lodeline/diagnostics.h"

namespace lodeline::gdal {

std::string MemoryFile::bytes() const {
  vsi_l_offset size = 0;
  const GByte* data = VSIGetMemFileBuffer(path_.c_str(), &size, FALSE);
  if (data == nullptr || size == 0) throw InputError("GDAL wrote nothing");
  return {reinterpret_cast<const char*>(data), static_cast<size_t>(size)};
}

void check(bool is_good, const char* what) {
  if (!is_good) throw InputError(fmt::format("GDAL cannot write {}: {}", what, CPLGetLastErrorMsg()));
}

GDALDatasetUniquePtr createDataset(const char* driver_name, const MemoryFile& file) {
  static std::once_flag once;
  std::call_once(once, [] { GDALAllRegister(); });
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(driver_name);
  check(driver != nullptr, driver_name);
  GDALDatasetUniquePtr dataset(driver->Create(file.path().c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  check(dataset != nullptr, driver_name);
  return dataset;
}

}  // namespace lodeline::gdal
