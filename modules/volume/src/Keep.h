// SPDX-License-Identifier: GPL-3.0-or-later
// A volume that holds its share of the memory budget for as long as anybody holds the volume.
#pragma once
#include <memory>
#include <utility>

#include "vernier/base/Budget.h"
#include "vernier/volume/Volume.h"

namespace vernier {

inline std::shared_ptr<const Volume> keepReservation(std::shared_ptr<const Volume> volume,
                                                     MemoryBudget::Reservation reservation) {
  struct Both {
    MemoryBudget::Reservation reservation;
    std::shared_ptr<const Volume> volume;
  };
  const auto both = std::make_shared<Both>(Both{std::move(reservation), std::move(volume)});
  return {both, both->volume.get()};
}

}  // namespace vernier
