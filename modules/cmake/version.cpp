// SPDX-License-Identifier: GPL-3.0-or-later
// libvernier is made of the modules' libraries; CMake wants one source of its own.
