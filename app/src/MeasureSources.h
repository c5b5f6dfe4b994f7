// SPDX-License-Identifier: GPL-3.0-or-later
// What a session has open, as the measure module asks for it.
#pragma once
#include "Session.h"
#include "vernier/measure/Measure.h"

namespace vernier::app {

// Refers to the session, which must outlive it; its functions may be called where the session's may.
measure::Sources measureSources(Session&, std::stop_token);

// PluginMissing where the plugin `measure` is not loaded: without it nothing measures.
Result<void> measuringPlugin(const Session&);

}  // namespace vernier::app
