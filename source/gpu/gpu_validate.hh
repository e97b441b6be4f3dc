// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_command_list.hh"

namespace gnomon::gpu {

/**
 * Check \a list against the resources and limits of \a device. Device::submit calls this for every backend in builds
 * with assertions (without NDEBUG).
 *
 * The function reports:
 * - passes that are nested or not ended, draws outside of passes, and updates inside of passes;
 * - draws for which no state was set in the same pass;
 * - ids of destroyed resources;
 * - bound buffers whose kind, size, alignment or range is wrong;
 * - viewports and scissors outside of the framebuffer;
 * - bindings and push constants that the current shader declares but the list does not set;
 * - textures that are sampled while they are attached to the framebuffer, without PassActions::reads_attachments;
 * - draws that read beyond the arrays of the list or outside of the vertex and index data of live batches.
 *
 * \throws Error for the first violation, naming the pass, the command, the resource and the reason
 */
void validate(const CommandList &list, const Device &device);

}  // namespace gnomon::gpu
