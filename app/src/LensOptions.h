// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses on the command line: --lens and --lens-inner.
#pragma once
#include "ViewOptions.h"

namespace vernier::app {

void addLensFlags(CLI::App&, LensOptions&);

// sphere:x,y,z,r  box:x,y,z,sx,sy,sz  cone:x,y,z,x,y,z,r[,r] in patient mm. OptionInvalid for all else.
Result<LensShape> parseLensShape(const std::string&);
// cut-out, mip, iso[:LEVEL], window:C,W, or a preset's name, of what is behind the lens in values of `unit`.
Result<LensInner> parseLensInner(const std::string&, const Layer& behind, const std::string& unit);

// Puts them into the scene; those that are given take the place of the view's own. A FILE is a lens layer as
// JSON (its surfaces are files beside it), or a surface file whose hull is taken.
Result<void> addLenses(Session&, Scene&, const ViewOptions&, const ProgressFn&, std::stop_token);

}  // namespace vernier::app
