// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "vernier/plan/Technique.h"

namespace vernier::angiography {
Technique sampledProjectionTechnique(Host&);
Technique exactProjectionTechnique(Host&);
Technique glProjectionTechnique(Host&);

struct ShellStore;
Technique nativeShellsTechnique(std::shared_ptr<ShellStore>);
Technique glShellsTechnique(Host&, std::shared_ptr<ShellStore>);
Technique glMaxShellsTechnique(Host&, std::shared_ptr<ShellStore>);
}  // namespace vernier::angiography
