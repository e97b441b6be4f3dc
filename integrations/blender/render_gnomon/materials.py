# SPDX-License-Identifier: MIT
"""What of Blender's materials does not reach a glTF file, and the volume of closed glass."""

import math

# Nodes of which the exporter of glTF makes something where they lead to a socket of the Principled BSDF.
KNOWN_NODES = {'TEX_IMAGE', 'NORMAL_MAP', 'SEPARATE_COLOR', 'SEPRGB', 'MAPPING', 'UVMAP', 'TEX_COORD', 'VERTEX_COLOR', 'MIX',
               'MIX_RGB', 'MATH', 'REROUTE', 'RGB', 'VALUE', 'ATTRIBUTE', 'GROUP_INPUT'}
# Surfaces that are drawn, with their sockets that are not in glTF and the values at which these have no effect. Names of 3.4, and of 4.0 and
# later.
IDLE_VALUES = {'BSDF_PRINCIPLED': {'Subsurface': 0.0, 'Subsurface Weight': 0.0, 'Anisotropic': 0.0}, 'BSDF_DIFFUSE': {'Roughness': 0.0},
               'EMISSION': {}, 'BACKGROUND': {}}
BLACK = {'base_color': (0.0, 0.0, 0.0), 'specular': 0.0}
# Cycles draws faces without a material as this Lambertian surface. The name is that in its Cryptomattes.
DEFAULT_NAME = 'default_surface'
DEFAULT_COLOR = (0.8, 0.8, 0.8)
# The roughness of surfaces that have none of their own: that of a new material of Blender.
ROUGHNESS = 0.5


def is_known(node):
    """Whether a node is of KNOWN_NODES and does not read an attribute of an object."""
    return node.type in KNOWN_NODES and not (node.type == 'ATTRIBUTE' and node.attribute_type != 'GEOMETRY')


def has_nodes(material):
    return material.use_nodes and material.node_tree is not None


def output_of(material):
    """The output that a render reads; None if there is none, or if the material has no nodes."""
    nodes = material.node_tree.nodes if has_nodes(material) else ()
    return next((node for node in nodes if node.type == 'OUTPUT_MATERIAL' and node.is_active_output), None)


def link_of(socket):
    """The link to a socket, beyond reroutes; None if it is not linked."""
    while socket.is_linked:
        link = socket.links[0]
        if link.from_node.type != 'REROUTE':
            return link
        socket = link.from_node.inputs[0]
    return None


def source_of(socket):
    """The node that a socket is linked to, beyond reroutes; None if it is not linked."""
    link = link_of(socket)
    return link.from_node if link else None


def upstream(socket, seen):
    node = source_of(socket)
    if node is not None and node not in seen:
        seen.append(node)
        for each in node.inputs:
            upstream(each, seen)
    return seen


def surface_nodes(material):
    """The nodes that lead to the surface of a material."""
    output = output_of(material)
    return upstream(output.inputs['Surface'], []) if output else []


def surface_of(material):
    """The node at the surface of a material; None if there is none, or if the material has no nodes."""
    output = output_of(material)
    return source_of(output.inputs['Surface']) if output else None


def is_volume_alone(material):
    """Whether a material has a volume and no surface, so that light passes it."""
    output = output_of(material)
    return output is not None and source_of(output.inputs['Surface']) is None and source_of(output.inputs['Volume']) is not None


def first_of(material, kind):
    """The first node of a kind that leads to the surface of a material, which glTF's exporter reads; None if there is none."""
    above = surface_nodes(material)
    return next((node for node in material.node_tree.nodes if node.type == kind and not node.mute and node in above), None) if above else None


def principled_of(material):
    return first_of(material, 'BSDF_PRINCIPLED')


def emission_of(material):
    return first_of(material, 'EMISSION') or first_of(material, 'BACKGROUND')


def plain_values(material):
    """Properties of Gnomon of a material with nodes that are drawn neither from a file nor in the viewport; None for others."""
    if not has_nodes(material):
        return None
    surface = surface_of(material)
    if surface is None:
        return {**BLACK, 'alpha': 0.0} if is_volume_alone(material) else BLACK
    if surface.type == 'BSDF_DIFFUSE' or principled_of(material) or emission_of(material):
        return None
    return {'base_color': tuple(material.diffuse_color[:3])}


def placing_remarks(material):
    """Sentences about images that are not placed by a uv set."""
    remarks = []
    for node in surface_nodes(material):
        if node.type == 'TEX_IMAGE' and node.image:
            kinds = [link.from_socket.name for each in [node, *upstream(node.inputs['Vector'], [])] for socket in each.inputs
                     for link in socket.links if link.from_node.type == 'TEX_COORD']
            kind = next((each for each in kinds if each != 'UV'), None) or (node.projection if node.projection != 'FLAT' else None)
            if kind:
                remarks.append(f"the image '{node.image.name}' is drawn by the uv set, not by {kind.capitalize()}")
    return remarks


def remarks_of(material):
    """Sentences about what of a material is not drawn."""
    if not has_nodes(material):
        return []
    output = output_of(material)
    if output is None:
        return ["it has no output, so that Blender draws it black"]
    remarks = placing_remarks(material)
    surface = source_of(output.inputs['Surface'])
    if surface is None:
        remarks.append("it has a volume and no surface, and is not drawn" if is_volume_alone(material) else
                       "its output has no surface, so that Blender draws it black")
    elif surface.type in IDLE_VALUES:
        for socket in surface.inputs:
            unknown = sorted({node.name for node in upstream(socket, []) if not is_known(node)})
            if unknown:
                remarks.append(f"'{socket.name}' comes from the nodes {', '.join(unknown)}, which are not drawn; bake them to a picture")
            is_opaque = getattr(material, 'blend_method', None) == 'OPAQUE'
            if socket.name == 'Alpha' and is_opaque and (socket.is_linked or socket.default_value != 1.0):
                remarks.append("its alpha is not drawn, as in EEVEE: its blend mode is Opaque")
            idle = IDLE_VALUES[surface.type].get(socket.name)
            if idle is not None and (socket.is_linked or socket.default_value != idle):
                remarks.append(f"'{socket.name}' is not drawn")
    else:
        parts = [f"'{node.name}'" for node in (principled_of(material), emission_of(material)) if node]
        remarks.append(f"its surface is the node '{surface.name}', which is not drawn, but " +
                       (f"{' and '.join(parts)} before it" if parts else "the material's colour for viewports") + "; use a Principled BSDF")
    if source_of(output.inputs['Displacement']) is not None:
        remarks.append("its displacement is not drawn")
    # EEVEE's option before 4.2.
    if getattr(material, 'shadow_method', 'OPAQUE') == 'NONE':
        remarks.append("its shadow mode None is not drawn, as in Cycles; Object Properties > Visibility > Shadow hides the shadow of an object")
    volume = source_of(output.inputs['Volume'])
    if volume is not None and surface is not None and volume.type != 'VOLUME_ABSORPTION':
        remarks.append(f"its volume, the node '{volume.name}', is not drawn")
    return remarks


def uses_color_attribute(material):
    """Whether a material reads the colours of vertices."""
    return material is not None and has_nodes(material) and any(
        node.type in ('VERTEX_COLOR', 'ATTRIBUTE', 'GROUP') for node in material.node_tree.nodes)


def color_name(socket):
    """The name of the colours of vertices that a socket is linked to, "" for those for renders; None if to others."""
    link = link_of(socket)
    if link is None or link.from_socket.name != 'Color':
        return None
    node = link.from_node
    if node.type == 'VERTEX_COLOR':
        return node.layer_name
    return node.attribute_name or None if node.type == 'ATTRIBUTE' and node.attribute_type == 'GEOMETRY' else None


def base_color_name(material):
    """The same of the base colour of a material."""
    surface = surface_of(material)
    name = {'BSDF_PRINCIPLED': 'Base Color', 'BSDF_DIFFUSE': 'Color'}.get(surface.type) if surface else None
    return color_name(surface.inputs[name]) if name else None


def colors_of(mesh, name):
    """The colours of vertices of a mesh by their name, or those for renders if it is ""; None if the mesh has none."""
    all_colors = mesh.color_attributes
    if name == "" and 0 <= all_colors.render_color_index < len(all_colors):
        return all_colors[all_colors.render_color_index]
    return all_colors.get(name) if name else None


def absorption(material):
    """(attenuation colour, attenuation distance in metres) of a Volume Absorption at the output; None if there is none."""
    output = output_of(material)
    volume = source_of(output.inputs['Volume']) if output else None
    if volume is None or volume.type != 'VOLUME_ABSORPTION':
        return None
    density, color = volume.inputs['Density'], volume.inputs['Color']
    if density.is_linked or color.is_linked or density.default_value <= 0:
        return None
    # Blender: exp(-density · (1 - colour) · d). glTF: attenuation colour ^ (d / attenuation distance).
    return [math.exp(min(c, 1.0) - 1.0) for c in color.default_value[:3]], 1.0 / density.default_value
