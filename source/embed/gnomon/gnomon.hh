// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_camera.hh"
#include "eevee_scene_renderer.hh"
#include "gltf_background_import.hh"
#include "gltf_export.hh"
#include "gltf_import.hh"
#include "gpu_device.hh"
#include "overlay.hh"
#include "scene.hh"
#include "unlit_engine.hh"

/**
 * The header for hosts: includes everything that a host needs to show a lit scene in its own window. See
 * doc/embedding.md for an explanation and examples/ for complete programs.
 *
 *     auto device = gnomon::gpu::create_gl_device({.context = gnomon::gpu::ContextKind::Host});
 *     gnomon::scene::Scene scene = gnomon::gltf::import_gltf("scene.glb");
 *     gnomon::eevee::SceneRenderer renderer(*device, scene, size_px, {.sample_count = 64});
 *     // Each frame, after edits of the scene:
 *     renderer.sync();
 *     renderer.draw_sample(camera, {.framebuffer = gnomon::gpu::HostFramebuffer{.size_px = size_px}});
 *
 * Lifetimes: the device and the scene must outlive the renderer. Threads: calls that use the device are made on the
 * thread of the host's OpenGL context, which must be current. Another thread may edit the scene and call
 * SceneRenderer::prepare, whose packets the device's thread submits. Gnomon leaves the state of the context as it was.
 */
