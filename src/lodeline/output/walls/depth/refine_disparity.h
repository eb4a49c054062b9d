#pragma once

#include <opencv2/core.hpp>

namespace lodeline {

/// Disparities with their uncertainty, px, CV_32F. Negative where there is none.
struct Disparities {
  cv::Mat value_px, sigma_px;
};

/// Refines disparities to fractions of a pixel by least squares on grey values in a window, with an offset
/// between the images (B. Lucas, T. Kanade, IJCAI 1981, along rows alone):
///
///     delta = -cov(g, e) / var(g),    e(u, v) = first(u, v) - second(u - d, v),
///
/// with the gradient g of the second image at u - d. Both images are blurred first, because the noise of a
/// gradient makes the steps too short. Before each step, every disparity becomes the mean of its window: a
/// step moves the window as a whole and leaves the errors between its pixels. Windows with an edge are not
/// smoothed.
///
/// The sigma is that of delta by the residuals, and a floor for what the window cannot know. The blur makes
/// pixels share their noise, which the sigma counts. `disparity_px`: CV_32F, negative where there is none.
/// Disparities that move by more than one pixel are removed.
Disparities refineDisparity(const cv::Mat& first, const cv::Mat& second, const cv::Mat& disparity_px);

}  // namespace lodeline
