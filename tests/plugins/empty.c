/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A shared object that is not a voice plugin. */
__attribute__((visibility("default"))) const int faccia_nothing = 1;
