// SPDX-License-Identifier: GPL-3.0-or-later
// Slices of colour volumes: each channel is drawn by itself, by what draws grey volumes, and then put
// together.
#pragma once
#include <functional>

#include "NativeJob.h"

namespace vernier::mpr {

// Draws one channel's values (View::wantValues is set).
using DrawGrey = std::function<Result<void>(const native::SliceJob&, Images&, std::stop_token)>;

// Red, green and blue are shown with the opacity of alpha, which is not premultiplied, over the background:
// each of the four is interpolated by itself. Values are NaN: a colour has none.
Result<void> drawColourSlice(const SliceParams&, Images&, std::stop_token, const DrawGrey&);

}  // namespace vernier::mpr
