"""Degrees of latitude and longitude to metres on a plane, by a transverse Mercator of the path's own."""

from collections.abc import Callable

import numpy as np

from osculate.curve.files.found import Array, refuse

WIDEST = 5e5  # m, from the origin: beyond, the plane is none (1 part in 600 at this distance)


def project(
    longitude: Array, latitude: Array, where: Callable[[int], str], label: str
) -> tuple[Array, str]:
    """Metres east and north of the first point (WGS 84), shape (n, 2), and that point in words.

    Args:
        longitude: Degrees, shape (n,).
        latitude: Degrees, shape (n,).
        where: Words for the place of a point in the file.
        label: The file, for messages.

    Raises:
        InvalidInput: Not on the globe, or too far apart for one plane.
    """
    for name, degrees, limit in (("latitude", latitude, 90.0), ("longitude", longitude, 360.0)):
        wrong = np.abs(degrees) > limit
        if wrong.any():
            n = int(wrong.argmax())
            raise refuse(
                label, f"its {name} is {degrees[n]:g}, must be within ±{limit:g}", where(n)
            )
    from pyproj import Transformer

    lat, lon = float(latitude[0]), float(longitude[0])
    plane = f"+proj=tmerc +lat_0={lat:.12f} +lon_0={lon:.12f} +ellps=WGS84 +units=m"
    points = np.stack(
        Transformer.from_crs("EPSG:4326", plane, always_xy=True).transform(longitude, latitude),
        axis=1,
    )
    if not np.isfinite(points).all() or np.abs(points).max() > WIDEST:
        raise refuse(label, "its places lie too far apart for one plane (500 km)")
    return points, f"latitude {lat:.7f}°, longitude {lon:.7f}°; x east, y north"
