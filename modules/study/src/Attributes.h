// SPDX-License-Identifier: GPL-3.0-or-later
// Header -> Record: the attributes that the study model needs, checked one by one. Nothing here can fail:
// what is missing or wrong is absent in the record, or stands in pixelError.
#pragma once
#include "Header.h"
#include "Record.h"

namespace vernier {

Record recordFrom(const Header& header);

}  // namespace vernier
