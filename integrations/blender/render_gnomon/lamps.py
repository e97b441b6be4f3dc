# SPDX-License-Identifier: MIT
"""Lamps of Blender in the units and words of glTF and Gnomon (doc/conventions.md)."""

import math

LUMEN_PER_WATT = 683.0
SIZE_MIN = 1e-6
"""Metres. A smaller area lamp gives no light in Blender either."""


def emission_of_nodes(lamp):
    """(colour, factor, remark): what the node tree of a lamp multiplies its light by. EEVEE does not read the tree."""
    white = (1.0, 1.0, 1.0)
    output = next((n for n in lamp.node_tree.nodes if n.type == 'OUTPUT_LIGHT' and n.is_active_output), None)
    node = output.inputs['Surface'].links[0].from_node if output and output.inputs['Surface'].is_linked else None
    if node is None or node.type != 'EMISSION':
        return white, 1.0, "its node tree has no Emission at its output; its colour and power are used"
    color, strength = node.inputs['Color'], node.inputs['Strength']
    remark = None
    factor = strength.default_value
    if strength.is_linked:
        link = strength.links[0]
        if link.from_node.type == 'LIGHT_FALLOFF' and link.from_socket.name == 'Quadratic' \
                and not link.from_node.inputs['Strength'].is_linked:
            factor = link.from_node.inputs['Strength'].default_value
        else:
            remark, factor = f"the strength of its light comes from the node '{link.from_node.name}', which is not drawn", 1.0
    if color.is_linked:
        remark = f"the colour of its light comes from the node '{color.links[0].from_node.name}', which is not drawn"
        return white, factor, remark
    return tuple(color.default_value[:3]), factor, remark


def light_of(lamp):
    """(colour, energy, remarks) of a lamp: its linear colour, all factors >= 0, and its watts or W/m² without the colour."""
    color, energy, remarks = tuple(lamp.color), lamp.energy, []
    if lamp.use_nodes and lamp.node_tree:
        factors, factor, remark = emission_of_nodes(lamp)
        color, energy = tuple(c * f for c, f in zip(color, factors)), energy * factor
        remarks += [remark] if remark else []
    # Blender 4.2 and later have a temperature and an exposure.
    if getattr(lamp, 'use_temperature', False):
        color = tuple(c * f for c, f in zip(color, lamp.temperature_color))
    energy *= 2.0 ** getattr(lamp, 'exposure', 0.0)
    if energy < 0 or min(color) < 0:
        remarks.append("it takes light away, which is not drawn; it is written without light")
        color, energy = (1.0, 1.0, 1.0), 0.0
    return color, energy, remarks


def punctual(lamp):
    """(colour, intensity, remarks) in KHR_lights_punctual: linear factors, and lux of suns and candela of others."""
    color, energy, remarks = light_of(lamp)
    return list(color), energy * LUMEN_PER_WATT / (1.0 if lamp.type == 'SUN' else 4 * math.pi), remarks


def extras_of(lamp):
    """(extras, remarks): node extras of Gnomon for a lamp, and what of the lamp is not drawn."""
    extras, remarks = {}, []
    if lamp.type == 'SUN' and lamp.angle > 0:
        extras['gnomon_angle'] = min(lamp.angle, math.pi)
    if lamp.type in ('POINT', 'SPOT') and lamp.shadow_soft_size > 0:
        extras['gnomon_radius'] = lamp.shadow_soft_size
    if lamp.type == 'SPOT':
        extras['gnomon_spot_blend'] = lamp.spot_blend
    if lamp.type == 'AREA':
        width, height = lamp.size, lamp.size_y if lamp.shape in ('RECTANGLE', 'ELLIPSE') else lamp.size
        if getattr(getattr(lamp, 'cycles', None), 'is_portal', False):
            remarks.append("it is a portal, which Gnomon does not need; it is written without light")
        elif min(width, height) < SIZE_MIN:
            remarks.append("it has no area and is written without light")
        else:
            color, power, light_remarks = light_of(lamp)
            remarks += light_remarks
            extras.update(gnomon_lamp='area', gnomon_shape=lamp.shape.lower(), gnomon_size_x=width, gnomon_size_y=height,
                          gnomon_power=power, gnomon_color=list(color))
            if getattr(lamp, 'spread', math.pi) < math.pi - 1e-4:
                remarks.append(f"its spread of {math.degrees(lamp.spread):.0f}° is not drawn: it gives light in all directions")
    for name in ('diffuse', 'specular', 'transmission', 'volume'):
        factor = getattr(lamp, f'{name}_factor', 1.0)
        if factor != 1.0 and name in ('diffuse', 'specular'):
            remarks.append(f"its {name} factor of {factor:.3g} is not drawn")
    return extras, remarks


def properties_of(lamp):
    """(properties, remarks): those of gnomon.Scene.add_lamp for a lamp, and what of the lamp is not drawn."""
    extras, remarks = extras_of(lamp)
    color, energy, light_remarks = light_of(lamp)
    remarks += [remark for remark in light_remarks if remark not in remarks]
    values = {'name': lamp.name, 'kind': lamp.type, 'color': color, 'intensity': energy}
    if lamp.type == 'SUN':
        values['angle'] = extras.get('gnomon_angle', 0.0)
    if lamp.type in ('POINT', 'SPOT'):
        values.update(intensity=energy / (4 * math.pi), radius=extras.get('gnomon_radius', 0.0))
    if lamp.type == 'SPOT':
        values.update(spot_outer_angle=lamp.spot_size / 2, spot_blend=lamp.spot_blend)
    if lamp.type == 'AREA':
        if 'gnomon_lamp' in extras:
            values.update(area_shape='ELLIPSE' if lamp.shape in ('DISK', 'ELLIPSE') else 'RECTANGLE', area_size_x=extras['gnomon_size_x'],
                          area_size_y=extras['gnomon_size_y'])
        else:
            values['intensity'] = 0.0
    return values, remarks
