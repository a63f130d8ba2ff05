"""Time-stepping of Moreau and Jean: fixed steps in which all laws of junctions hold at the end."""
