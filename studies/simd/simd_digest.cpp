// Prints a digest of what every function with LODELINE_WIDE_VECTORS computes from the same random input, one
// line a source file. The program is built with and without that attribute; both must print the same.

#include <cstdint>
#include <cstdio>
#include <opencv2/core.hpp>
#include <random>
#include <span>
#include <vector>

#include "lodeline/estimator/visual/reprojection_hessian.h"
#include "lodeline/frontend/detection/image_pyramid.h"
#include "lodeline/frontend/detection/structure_tensor.h"
#include "lodeline/frontend/tracking/patch_sampling.h"
#include "lodeline/io/images/png_filters.h"
#include "lodeline/problem/simd_gemm.h"
#include "simulation/rendering/cave/solid_texture.h"

namespace lodeline {
namespace {

std::mt19937 engine(7);

double number() { return std::normal_distribution<double>()(engine); }
int integer(int below) { return static_cast<int>(engine() % static_cast<unsigned>(below)); }

template <typename Matrix>
void fill(Matrix& matrix) {
  for (auto& value : matrix.reshaped()) value = number();
}

cv::Mat randomImage(int width, int height) {
  cv::Mat image(height, width, CV_8UC1);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) image.at<uint8_t>(v, u) = static_cast<uint8_t>(integer(256));
  return image;
}

/// FNV-1a of the bytes that it is given.
class Digest {
 public:
  explicit Digest(const char* source) : source_(source) {}
  ~Digest() { std::printf("%s %016llx\n", source_, static_cast<unsigned long long>(hash_)); }
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;

  template <typename T>
  void add(const T* values, size_t count) {
    for (const uint8_t byte : std::span(reinterpret_cast<const uint8_t*>(values), count * sizeof(T)))
      hash_ = (hash_ ^ byte) * 0x100000001b3ULL;
  }
  template <typename Matrix>
  void addMatrix(const Matrix& matrix) {
    add(matrix.data(), static_cast<size_t>(matrix.size()));
  }
  void addImage(const cv::Mat& image) {
    for (int v = 0; v < image.rows; ++v) add(image.ptr<float>(v), static_cast<size_t>(image.cols));
  }

 private:
  const char* source_;
  uint64_t hash_ = 0xcbf29ce484222325ULL;
};

void digestProducts() {
  Digest digest("lodeline/problem/simd_gemm.cpp");
  for (int i = 0; i < 200; ++i) {
    Eigen::MatrixXd a(1 + integer(40), 1 + integer(30)), b(1 + integer(40), a.cols());
    Eigen::MatrixXd c(a.rows(), b.rows()), square(a.rows(), a.rows());
    fill(a), fill(b), fill(c), fill(square);
    subtractProduct(a, b, c);
    subtractSquare(a, square);
    digest.addMatrix(c);
    digest.addMatrix(Eigen::MatrixXd(square.triangularView<Eigen::Lower>()));
  }
}

void digestHessian() {
  Digest digest("lodeline/estimator/visual/reprojection_hessian.cpp");
  HostProducts host = HostProducts::Zero();
  CalibrationProducts calibration = CalibrationProducts::Zero();
  for (int i = 0; i < 200; ++i) {
    ObservationRows rows;
    fill(rows);
    addProducts(rows, &host);
    addProducts(rows, &calibration);
  }
  digest.addMatrix(host);
  digest.addMatrix(calibration);
}

void digestImages() {
  Digest pyramids("lodeline/frontend/detection/image_pyramid.cpp");
  Digest tensors("lodeline/frontend/detection/structure_tensor.cpp");
  Digest patches("lodeline/frontend/tracking/patch_sampling.cpp");
  for (const int width : {64, 97, 131, 160}) {
    for (const int side : {3, 7}) {
      const ImagePyramid pyramid(randomImage(width, 83), 2, side);
      for (int level = 0; level < pyramid.levels(); ++level) pyramids.addImage(pyramid.level(level));
      const cv::Mat& image = pyramid.level(0);
      const cv::Rect cell(5, 6, width - 11, 40);
      const StructureTensor tensor(image, cell);
      for (int v = 0; v < cell.height; ++v) {
        for (int u = 0; u < cell.width; ++u) {
          const float gradient = tensor.weakerGradientGreyPerPx(u, v);
          tensors.add(&gradient, 1);
        }
      }
      for (int i = 0; i < 100; ++i) {
        PatchWarp warp;
        warp.position = {static_cast<float>(20 + integer(24)) + 0.37F,
                         static_cast<float>(20 + integer(40)) + 0.61F};
        warp.linear << 1.05F, 0.02F * static_cast<float>(number()), -0.03F, 0.95F;
        PatchValues values;
        sample(image, warp, values);
        patches.add(values.data(), values.size());
      }
    }
  }
}

void digestPng() {
  Digest digest("lodeline/io/images/png_filters.cpp");
  for (int i = 0; i < 100; ++i) {
    const int width = 1 + integer(300), height = 1 + integer(40);
    std::vector<uint8_t> filtered(static_cast<size_t>(height) * static_cast<size_t>(width + 1));
    for (uint8_t& byte : filtered) byte = static_cast<uint8_t>(integer(256));
    for (int v = 0; v < height; ++v)
      filtered[static_cast<size_t>(v) * static_cast<size_t>(width + 1)] = static_cast<uint8_t>(integer(5));
    std::vector<uint8_t> pixels(static_cast<size_t>(width) * static_cast<size_t>(height));
    if (png::unfilter(filtered.data(), width, height, pixels.data()))
      digest.add(pixels.data(), pixels.size());
  }
}

void digestTexture() {
  Digest digest("simulation/rendering/cave/solid_texture.cpp");
  const SolidTexture texture(3);
  for (int i = 0; i < 5000; ++i) {
    Vec3f point;
    fill(point);
    const TextureSample sample = texture.sample(point, 0.7F, 0.001F * static_cast<float>(1 + integer(60)));
    digest.add(&sample.reflectance, 1);
    digest.addMatrix(sample.slope);
  }
}

}  // namespace
}  // namespace lodeline

int main() {
  lodeline::digestProducts();
  lodeline::digestHessian();
  lodeline::digestImages();
  lodeline::digestPng();
  lodeline::digestTexture();
}
