"""Images, transforms and markups, as nibabel, ITK and 3D Slicer have them."""
