// SPDX-License-Identifier: GPL-3.0-or-later
// VERNIER_API marks what libvernier.so shows to the program and to plugins; all else stays hidden.
#pragma once
#define VERNIER_API __attribute__((visibility("default")))
