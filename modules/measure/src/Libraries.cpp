// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/Libraries.h"

#include <opencv2/core/utility.hpp>

namespace vernier::measure {

std::string imageLibrary() { return "OpenCV " + cv::getVersionString(); }

}  // namespace vernier::measure
