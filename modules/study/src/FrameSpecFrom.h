// SPDX-License-Identifier: GPL-3.0-or-later
// Attributes of the Image Pixel module (PS3.3 C.7.6.3) -> FrameSpec. The VR of every attribute that is acted
// on is checked: a value of another VR is an error, but for UN, whose bytes are read as little endian
// (PS3.5 6.2.2). Errors: PixelDescriptionInvalid, LimitExceeded, CodecUnsupported (a transfer syntax that
// decode() does not know). Contradictions that all readers settle alike are settled and named in
// FrameSpec::corrected. The data set need not hold the pixel data itself; where it was read up to there,
// Float and Double Float Pixel Data are recognised by the SOP Class. Internal to this module.
#pragma once
#include <string>

#include "vernier/base/Result.h"
#include "vernier/study/FrameSpec.h"

class DcmItem;

namespace vernier {

Result<FrameSpec> frameSpecFrom(DcmItem& dataset, const std::string& transferSyntaxUid);

}  // namespace vernier
