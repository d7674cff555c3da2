# What the window says in simplified Chinese; config/languages/en/window.ftl holds the English of every message.

language-name = 简体中文
    .latin = Chinese (simplified)

## Keys that are held with another one

key-ctrl = Ctrl
key-alt = Alt
key-shift = Shift

## Words that many places share

off = 关
none = 无
cancel = 取消
reset = 重置
undo = 撤销
redo = 重做
open = 打开
export = 导出
length-mm = { $value } mm
area-mm2 = { $value } mm²
volume-mm3 = { $value } mm³
time-ms = { $value } ms
percent = { $value } %
size-bytes = { $value } B
size-kilobytes = { $value } kB
size-megabytes = { $value } MB
triangles = { $count } 个三角面
both-keys = { $first } 和 { $second }
name-with-keys = { $name } ({ $keys })

## Pages at the right

page-look = 外观
    .about = 黏土的显示方式
page-scene = 场景
    .about = 第二个物体、布尔运算、细节级别、修剪
page-walls = 壁厚
    .about = 壁厚与过薄之处
page-measure = 尺寸
    .about = 测量、沿方向的投影、与另一形体的距离
page-files = 文件
    .about = 打开、导出、图像
page-devices = 笔
    .about = 设备及其实时数值
page-loop = 循环
    .about = 计算循环与此窗口的耗时
page-more = 更多
    .about = 偏好设置与消息

## Brushes

kind-gaussian = 高斯
    .about = 沿表面法线隆起钟形黏土 (Cipollini 2020)。
kind-smooth = 光滑
    .about = 使表面平整: 余切权重拉普拉斯算子, 强度为一次点按走过的比例。
kind-draw = 绘制
    .about = 按衰减沿表面平均法线抬高表面。
kind-clay = 黏塑
    .about = 以平层堆积黏土: 填到略高于表面的平面。
kind-clay-strips = 黏条
    .about = 以平顶方端的条带铺黏土, 方向随笔画。
kind-inflate = 膨胀
    .about = 使形体膨胀: 每个顶点沿自身法线移动。
kind-layer = 层次
    .about = 每次笔画一层等高的黏土, 无论经过几次。
kind-crease = 折痕
    .about = 刻出两侧靠拢的沟槽; 反向则隆起脊线。
kind-pinch = 夹捏
    .about = 将表面拉向笔刷中心; 反向则摊开。
kind-blob = 球体
    .about = 隆起圆滴: 表面从下方一点鼓起。
kind-flatten = 平化
    .about = 把凸起与凹陷拉向平均平面; 反向则加深。
kind-fill = 填充
    .about = 把凹陷填到平均平面, 保留凸起; 反向则削低凸起。
kind-scrape = 刮削
    .about = 把凸起削到平均平面, 保留凹陷; 反向则填平凹陷。
kind-trim = 修剪
    .about = 像刀一样切去高出表面下方平面的部分。
kind-grab = 抓起
    .about = 落笔时笔刷下的部分随笔移动。
kind-elastic = 弹性变形
    .about = 像固定于一点的弹性体那样移动黏土 (正则化 Kelvinlet, de Goes 与 James 2017)。
kind-topological = 拓扑抓起
    .about = 同抓起, 但抓住的是沿表面而非隔空邻近的部分。
kind-snake-hook = 蛇形钩
    .about = 跟随笔把黏土拉出来。
kind-twist = 扭转
    .about = 笔向右移动时, 绕表面法线旋转笔刷下的部分。
kind-thumb = 拇指
    .about = 沿表面涂抹笔刷下的部分。
kind-nudge = 推移
    .about = 随笔画推动表面。
kind-relax = 松弛
    .about = 沿表面使三角面均匀, 不改变形体。
kind-mask = 遮罩
    .about = 保护所涂部分不受其他笔刷影响; 反向则解除。
kind-mask-blur = 遮罩模糊
    .about = 柔化遮罩边缘; 反向则锐化。
kind-paint = 绘画
    .about = 把笔刷颜色涂到黏土上。
kind-texture = 纹理
    .about = 沿笔画压出随之弯曲并重复的 Alpha 浮雕。
kind-density = 密度
    .about = 使三角面达到相对笔刷的目标大小并均匀; 形体不变。
kind-simplify = 简化
    .about = 把小三角面合并到相对笔刷的目标大小; 大的与形体不变。
kind-slide-relax = 滑动松弛
    .about = 随笔画沿表面滑动三角面, 不改变形体; 按 Shift 或反向则松弛。
kind-plane = 平面
    .about = 把凸起与凹陷拉到笔画开始时表面的平均平面; 反向则加深。
kind-multiplane-scrape = 多平面刮削
    .about = 刮出沿笔画相交的两个平面, 留下两侧平整的棱。
kind-sharpen = 锐化
    .about = 突出细小起伏; 反向则减弱。
kind-surface-smooth = 表面光滑
    .about = 使表面平整并保持体积 (Taubin 1995)。
kind-boundary = 边界
    .about = 开放表面的边界随笔移动, 其后的表面亦然。
kind-erase-layer = 擦除图层
    .about = 去除活动图层的效果; 表面回到其下方的样子。
kind-draw-face-sets = 绘制面组
    .about = 绘制面组: 每笔一个新组; 反向则延续起笔处的面组。

## Numbers of single brushes

number-depth = 深度
    .blob = 该点在表面下多深, 以半径计
    .plane = 作用层在平面下多深, 以半径计
    .trim = 全强度时切入表面下多深, 以半径计
number-lift = 抬升
    .about = 全强度时平面高出表面多少, 以半径计
number-fill = 填充
    .about = 每移动五分之一半径向平面靠近的比例
number-roundness = 圆度
    .about = 0 为方形, 1 为圆形
number-pinch = 夹捏
    .about = 两侧靠拢的程度
number-poisson = 泊松比
    .about = 黏土保持体积的程度: 0.5 为完全
number-offset = 偏移
    .about = 平面沿法线移动多少, 以半径计
number-angle = 角度
    .about = 两平面法线之间, 度
number-height = 高度
    .about = 作用层在平面上多高, 以半径计
number-scale = 缩放
    .about = 一次重复的长度, 以笔刷宽度计
number-floor = 基准
    .about = 留在表面上的 Alpha 高度; 更低的部分被压入
number-width = 宽度
    .about = Alpha 宽度, 以笔刷宽度计: 小于 1 重复, 大于 1 裁剪
number-set = 面组
    .about = 所绘面组的编号; 0: 每笔开始一个新组

## The brush's settings

brush-heading = 笔刷
brush-more = 更多笔刷
brush-now = 笔刷: { $name }
brush-own = 自己的笔刷
    .tip = { $what } (再按一次: 恢复保存时的设置)
brush-own-about = { $kind }: { $about }
brush-radius = 半径
    .tip = 相对物体大小的比例 ({ $keys }, 或 { $drag } 并拖动)
brush-strength = 强度
    .tip = 一次点按的作用大小 ({ $keys }, 或 { $drag } 并拖动)
brush-carve = 雕入
    .tip = { $action }; 按住 Ctrl 只对一次笔画有效
brush-stroke = 笔画
brush-settings = 更多设置
brush-dab = 点按的形状
brush-stamp = Alpha 与图章
brush-automasks = 自动遮罩
brush-topology = 动态拓扑

stroke-spacing = 间距
    .tip = 点按之间的距离, 为半径的比例
stroke-stabilizer = 稳定器
    .tip = 笔刷以此距离跟随笔: 视图高度的比例
stroke-steadiness = 平稳
    .tip = 笔刷跟随笔的线长, 以半径计
stroke-average = 平均采样数
    .tip = 笔刷移到笔的这么多次采样的平均处
stroke-jitter = 抖动
    .tip = 点按在路径周围散布多远, 以半径计
stroke-seed = 抖动种子:
stroke-method = 方法
stroke-continuous = 笔静止时继续
stroke-ticks = 静止时点按间隔
stroke-compensate = 任何间距强度相同
    .tip = 强度按笔的路程计; 关: 每次点按都是全部强度
stroke-accumulate = 累积
    .tip = 笔画可在自己抬高之处继续堆积
stroke-limit = 笔画限度
    .tip = 一次笔画最多移动一点多远, 以一次完整点按的高度计; 0: 无限制

method-space = 等距
method-dots = 点
method-airbrush = 喷枪
method-anchored = 锚定
method-drag-dot = 拖动点
method-line = 直线
method-curve = 按点曲线

dab-falloff = 衰减
dab-curve-tip = 半径的八分之 { $eighths } 处
dab-hardness = 硬度
    .tip = 笔刷完全起作用的半径比例
dab-smoothing = 光滑
    .tip = 每次点按以此强度光滑
dab-averaging = 平均
    .tip = 计算表面平均平面的半径比例
dab-plane-trim = 平面限度
    .tip = 离平面更远的部分不变, 以半径计; 0: 无
dab-tilt = 倾斜
    .tip = 点按随笔倾斜的程度
dab-colour = 颜色

falloff-gaussian = 高斯
falloff-smooth = 平滑
falloff-sphere = 球形
falloff-root = 根式
falloff-sharp = 锐利
falloff-linear = 线性
falloff-constant = 恒定
falloff-custom = 自定义

stamp-alpha = Alpha
stamp-stamp = 图章
stamp-size = 图章大小
stamp-angle = 图章角度
stamp-repeat = 重复图章
stamp-right = 模板向右
stamp-up = 模板向上
stamp-at-tip = 从视图中心起, 以视图高度计
stamp-off = 无
stamp-dab = 每次点按之下
stamp-view = 沿视图
stamp-stencil = 模板

alpha-studs = 铆钉
alpha-scales = 鳞片
alpha-rope = 绳索
alpha-stitches = 针脚
alpha-waves = 波浪
alpha-bricks = 砖块
alpha-stone = 石头
alpha-cracks = 裂纹
alpha-picture = 载入的图像

automask-front = 仅正面
automask-topology = 仅相连部分
automask-sets = 仅限首次触及的面组
automask-boundary = 边界不动
    .tip = 开放表面的边界不移动
automask-normal = 法线限度
    .tip = 仅偏离点按法线不超过此度数的部分; 0: 全部
automask-cavity = 凹陷
    .tip = 大于 0 只作用于凹陷, 小于 0 只作用于脊

topology-by = 边长
topology-length = 长度
topology-split = 拆分长边
topology-collapse = 塌陷短边
topology-off = 关
topology-brush = 相对笔刷
topology-object = 相对物体
topology-view = 相对视图

## Mirror, pressure, masks, history

mirror-heading = 镜像

pressure-heading = 压力
pressure-curve = 压力曲线
    .tip = 拖动左端设最轻触碰, 拖动中间设弯曲
pressure-lightest = 最轻
pressure-bend = 弯曲
pressure-radius = 半径
    .tip = 最轻触碰时的半径比例

mask-heading = 遮罩
mask-clear = 清除
    .tip = 全部自由
mask-fill = 填充
    .tip = 全部保护
mask-invert = 反转
    .tip = 自由的被保护, 被保护的变自由
mask-blur = 模糊
    .tip = 更柔的边缘
mask-sharpen = 锐化
    .tip = 更硬的边缘
mask-grow = 扩展
    .tip = 多一圈顶点
mask-shrink = 收缩
    .tip = 少一圈
mask-cavity = 凹陷
    .tip = 保护凹陷
mask-thin = 薄处
    .tip = 厚度不超过此值的部分受保护
mask-occlusion = 遮蔽处
    .tip = 被物体自身遮住光线的部分受保护
mask-thin-below = 薄度
    .tip = 占最长边的比例
mask-note = { $keys } 显示它; 用遮罩笔刷绘制

history-heading = 历史
history-steps = { $at } / { $all }
history-versions = { $count ->
   *[other] { $count } 个版本
}
history-step = 步骤
    .tip = 拖动以浏览各步骤
history-after = 步骤 { $step } 之后
history-version = 版本
    .tip = 拖动以浏览这条线上的版本
history-row = 版本 { $node }, { $time }
history-row-branch = 版本 { $node }, { $time }, 分支
history-replaced = 替换
history-added = 添加
history-removed = 移除
history-duplicated = 复制
history-renamed = 重命名
history-moved = 移动
history-activated = 激活
history-shown = 显示或隐藏
history-locked = 锁定或解锁
history-reshaped = 改形
history-layers = 图层
history-sets = 面组
history-mask = 遮罩
history-remesh = 三角形大小
history-snapped = 已贴合
history-boolean = 布尔
history-merged = 合并
history-split = 拆分

## Page: look

look-material = 材质
material-clay = 黏土
material-porcelain = 瓷
material-wax = 蜡
material-stone = 石
material-jade = 玉
material-bronze = 青铜
material-graphite = 石墨
look-facets = 平直着色
look-cavity = 凹陷
    .tip = 凹处更暗, 脊更亮
look-occlusion = 遮蔽
    .tip = { $action }: 屏幕空间环境光遮蔽
look-wireframe = 线框
look-grid = 栅格
look-smooth-edges = 平滑边缘
    .tip = 每像素四次采样; 无显卡时耗时
look-map = 图
map-none = 无
    .tip = 黏土本身
map-mask = 遮罩
map-thickness = 厚度
map-distance = 距离
look-camera = 摄像机
look-orthographic = 正交
look-angle = 角度
    .tip = 视野, 度
look-keep = 保存视角
    .tip = 以编号保存此视角，以便返回
    .show = 再次显示此视角；右键单击可删除
legend-measuring = 测量中

## Page: scene

scene-object = 物体
scene-size = { $x } x { $y } x { $z } { $unit }
scene-held = 手持物体
    .tip = 出现在物体旁, 可移入其中
scene-held-note = 拿起一个形体, 移到位, 然后合并、切除或保留。
scene-add = 合并
    .tip = 两者成为一体
scene-cut = 切除
    .tip = 从物体中切去手持物体
scene-keep = 保留
    .tip = 只留两者共有的部分
scene-put-down = 放下
    .tip = 在原处成为物体
scene-put-away = 收起
scene-busy = 后台计算中: 可继续雕刻
scene-preview = 预览
scene-computing = 计算中 ...
scene-shown = 手持物体的 { $count } 个三角面
scene-apply = 应用
    .tip = 执行所示结果
scene-dismiss = 放弃
    .tip = 物体与手持物体均不变
scene-yaw = 偏航
scene-pitch = 俯仰
scene-roll = 滚转
scene-scale = 缩放
scene-held-size = 大小

objects-heading = 物体
objects-add = 添加物体
objects-duplicate = 复制
objects-rename = 重命名
objects-remove = 移除
objects-locked = 已锁定: 不可雕刻、移动、移除
objects-gizmo = 操纵器
    .tip = 用指针移动、旋转和缩放对象；按住 Ctrl 按步进
objects-snap = 面对面贴合
    .tip = 把一个对象的平面贴到另一个对象的平面上
objects-snap-first = 按下要移动的面
objects-snap-second = 按下要贴合到的面
objects-eye = 显示
    .tip = 绘制
objects-lock = 锁定
    .tip = 防止雕刻、移动与移除
objects-reset-place = 重置位置
    .tip = 回到创建之处
shape-box = 立方体
shape-ball = 球体
shape-cylinder = 柱体
shape-cone = 锥体
shape-torus = 环体
shape-tube = 管
shape-plane = 平面
operation-union = 并集
    .tip = 活动物体与此物体成为一体
operation-intersection = 交集
    .tip = 只留两者共有的部分
operation-difference = 差集
    .tip = 从活动物体中切去此物体
operation-reverse-difference = 反向差集
    .tip = 从此物体中切去活动物体

sets-heading = 面组
sets-eye-tip = 显示或隐藏此面组
sets-colours = 以颜色显示
sets-isolate = 仅此
    .tip = 隐藏此面组以外的部分
sets-draw = 绘制
    .tip = 取用绘制此面组的笔刷
sets-none = 不在面组中：{ $count }
sets-row = 面组 { $number }：{ $count }
sets-hide-masked = 隐藏遮罩部分
    .tip = 隐藏遮罩达一半以上的部分
sets-invert = 反转显示
    .tip = 隐藏可见部分，显示隐藏部分
sets-show-all = 全部显示
    .tip = 不再隐藏任何部分
sets-clear = 清除面组
    .tip = 没有顶点再属于面组；已隐藏的保持隐藏
sets-from-mask = 由遮罩
    .tip = 遮罩达一半以上的部分成为面组
sets-from-visible = 由可见部分
    .tip = 所有可见部分成为一个面组
sets-loose = 分离部分
    .tip = 每个相连的部分成为一个面组
sets-normals = 按朝向
    .tip = 朝向大致相同的部分成为一个面组
sets-crease = 按折痕
    .tip = 面组在弯折超过此角度处分界
sets-degrees = 角度
sets-thickness = 厚度
    .tip = 占最长边的比例；小于 0 表示向内
sets-extract-mask = 提取遮罩
    .tip = 遮罩部分成为新对象：此厚度的封闭外壳
sets-extract-name = 提取

layers-heading = 图层
layers-add = 添加图层
    .tip = 笔画进入新图层
layers-name = 图层 { $number }
layers-base = 基底
    .tip = 笔画位于所有图层之下
layers-unseen = 活动图层已隐藏或强度为 0: 看不到笔画
layers-topology = 物体有图层时动态拓扑不工作; 烘焙图层后可用
layers-eye = 显示
    .tip = 可见
layers-up = 上移
    .tip = 移到上一图层之上
layers-down = 下移
    .tip = 移到下一图层之下
layers-merge = 向下合并
    .tip = 并入下方图层或基底。两者都须可见
layers-duplicate = 复制图层
    .tip = 在其上方建隐藏副本
layers-clear = 清空图层
    .tip = 去除其效果
layers-remove = 移除图层
    .tip = 连同效果移除
layers-rename = 重命名图层
layers-bake = 烘焙图层
    .tip = 当前表面成为基底

levels-heading = 级别
levels-at = 级别 { $at } / { $all }, { $count } 个三角面
levels-coarser = 更粗
    .tip = 塑造整体; 细级别的细节随之移动
levels-finer = 更细
    .tip = 每个三角面变为四个
    .back = 回到更细的级别

remesh-heading = 重构网格
remesh-own = 自定体素
    .tip = 否则新三角面与现有的大致同样大小
remesh-voxel = 体素
remesh-along = 最长边 { $count } 个
remesh-sharp = 保留锐边
remesh-button = 重构网格
    .tip = 由均匀三角面组成的单一表面; 重叠部分合为一体。{ $keys }
remesh-local-heading = 就地
remesh-local-edge = 边长
    .tip = 对象通常边长的倍数
remesh-local-undo = 随时可按 { $keys } 撤销，进行中也可以。
remesh-stretched = 细化拉伸处
    .tip = 在整个对象中分割过长的边；被遮罩或隐藏的部分保持不变

quads-heading = 四边形
quads-count = 四边形数
quads-levels = 更细级别
    .tip = 四边形为最低级别; 更细的级别找回细节
quads-button = 重构为四边形
    .tip = 沿形状走向的四边形; 没有级别时导出为四边形

decimate-heading = 减面
decimate-share = 保留的三角面
decimate-button = 减面
    .tip = 为打印和网页减少三角面。不产生新的自相交, 遮罩边界保持不变

trim-heading = 修剪
trim-box = 框
    .tip = 在视图上拖出框: 框内部分被彻底切去
trim-line = 线
    .tip = 在视图上拖出线: 其左侧被切去
trim-note = 在视图上拖动; Esc 取消。

region-heading = 视图区域
region-draw = 区域:
region-lasso = 套索
    .tip = 围绕目标拖动
region-box = 框
    .tip = 从一角拖到对角
region-line = 线
    .tip = 拖出一条线: 其左侧为目标
region-polyline = 折线
    .tip = 逐角点击
region-front = 仅正面
    .tip = 仅朝向你的面; 否则贯穿
region-mask = 遮罩
    .tip = 保护区域内的部分; 按 Ctrl 则解除
region-unmask = 解除遮罩
    .tip = 解除区域内的遮罩; 按 Ctrl 则保护
region-hide = 隐藏
    .tip = 隐藏区域内的部分; 按 Ctrl 则隐藏其余
region-isolate = 仅显示
    .tip = 隐藏区域以外的部分; 按 Ctrl 则隐藏区域内
region-face-set = 面组
    .tip = 区域内的部分成为新面组
region-remesh = 三角形大小
    .tip = 区域内的三角形获得此边长，贯穿整个对象
region-done = 完成
    .tip = 结束绘制区域 (Esc)
region-note = 在视图上拖动。Ctrl 反转, Esc 结束。
region-polyline-note = 点击各角; 再点首角或末角, 或按 Enter 闭合。

menu-add = 合并
menu-carve = 雕入
menu-keep = 保留共有
menu-put-away = 收起
menu-ball = 球体
menu-box = 立方体
menu-cylinder = 柱体
menu-undo = 撤销
menu-redo = 重做
menu-pick-up = 拿起

## Page: walls

walls-heading = 壁厚
walls-live = 实时图
walls-process = 工艺
walls-own-limit = 自定限度
walls-too-thin-below = 过薄限度
walls-note = 按 { $keys }: 雕刻时该图跟随黏土。
walls-thinnest = 最薄
walls-median = 中位数
walls-thickest = 最厚
walls-too-thin = 过薄
walls-measured = 已测
walls-spots = 过薄之处
walls-none = 没有低于限度之处。
walls-spot = { $number }: { $value } mm
    .tip = 摄像机飞到那里
walls-histogram = 壁厚直方图
    .tip = { $min } 至 { $max } mm; 线为限度
process-abs = 注塑, ABS
process-fdm = 熔融沉积 (FDM)
process-pa = 注塑, 聚酰胺 (PA)
process-pc = 注塑, 聚碳酸酯 (PC)
process-pom = 注塑, 聚甲醛 (POM)
process-pp = 注塑, 聚丙烯 (PP)
process-sla = 光固化 (SLA)
process-sls = 激光烧结 (SLS)

## Page: size

measure-heading = 测量
measure-waits = 无变化时测量。
measure-volume = 体积
measure-area = 面积
measure-size = 尺寸 { $axis }
measure-shadow = 投影 { $axis }
measure-stale = 为先前状态; 无变化时重新测量。
shadow-heading = 投影
shadow-along = 沿 { $axis } 的投影
    .tip = 沿 { $axis } 观看
shadow-here = 从此处
    .tip = 按摄像机方向观看
shadow-size = { $x } x { $y } mm, { $holes } 个孔
shadow-file = 要写的图纸
    .tip = 图纸文件
shadow-write = SVG
    .tip = 按比例的轮廓图纸, 毫米
shadow-outline = 投影轮廓
distance-heading = 距离
distance-live = 实时距离图
distance-before = 与先前
    .tip = 与打开时的物体
distance-held = 与手持物体
distance-now = 与现在比较
    .tip = 距离以物体现状为准
distance-note = 蓝色在内, 红色在外。
distance-deepest = 最深
distance-highest = 最高
distance-rms = 均方根
distance-known = 已知

## Page: files

files-open = 打开
    .note = 把网格拖到窗口上, 或:
files-open-name = 要打开的文件
files-browse = 浏览...
files-recent = 最近
files-earlier = 先前的作品
files-export = 导出
files-export-name = 要写的文件
files-scale = 比例
files-unit = 单位
unit-mm = mm
unit-cm = cm
unit-m = m
unit-inch = 英寸
files-save-as = 另存为...
files-pictures = 图像
files-screenshot = 截图
files-turntable = 转台
files-frames = 帧
files-replace = 替换
    .question = { $path } 已存在。要替换吗?

chooser-open = 打开网格
chooser-export = 导出作品
chooser-meshes = 网格
chooser-home = 主目录
chooser-documents = 文档
chooser-downloads = 下载
chooser-desktop = 桌面
chooser-up = 向上
chooser-reading = 读取中...
chooser-empty = 此处没有文件夹和网格文件
chooser-name = 名称

start-heading = 继续
start-note = 此新作品会随工作自动保存。
start-stay = 留在此处
start-session = { $object }, { $date } { $time }

## Page: pens

devices-heading = 设备
devices-none = 未找到数位板: 插上即可, 无需重启。
    .mouse = 鼠标也可雕刻: 慢速笔画压力更大。
devices-in-range = 当前感应
devices-pointer = 指针
devices-tablet = 数位板 { $number }
devices-serial = 串口笔 { $number }
devices-recording = 录制 { $number }
devices-demo = 演示笔 { $number }
devices-pen = 笔 { $number }
devices-eraser = { $pen }, 橡皮
devices-no-tilt = 无倾斜
devices-tilt = 倾斜 { $x }, { $y } 度
devices-pressure = 压力 { $pressure }, { $tilt }
devices-place = 位于视图 { $x } %, { $y } %
devices-hands = { $count ->
   *[other] 跟踪到 { $count } 只手
}
devices-strain = 手臂负担 { $percent } %
devices-rest = 手臂位置偏高: 请休息或降低位置。
devices-nothing = 无
devices-curve = 左侧压力曲线显示笔的实时轨迹。
pose-neutral = 空闲
pose-point = 食指
pose-pinch = 捏
pose-grab = 握拳
pose-flat = 平掌
pose-open = 张开

tablet-heading = 数位板按键
tablet-choose = 按下以选择
    .tip = 然后按数位板的键或笔上按钮, 或转动圆环。期间它不做别的
tablet-listening = 请按一个键...
tablet-usual = 照常 ({ $action })
tablet-action = { $control } 的动作
tablet-line = { $control }: { $action }
tablet-reset = 重置
    .tip = 恢复照常
tablet-none = 一切照常。
tablet-nothing = 无
tablet-next-mode = 下一模式
tablet-radius = 半径
    .back = 半径, 反向
tablet-strength = 强度
    .back = 强度, 反向
tablet-turn = 按住时旋转视图
tablet-slide = 按住时平移视图
tablet-zoom = 按住时缩放
tablet-radius-and-strength = 拖动调半径与强度
tablet-carve = 按住时雕入
tablet-brush = { $brush }笔刷
    .held = 按住时用{ $brush }笔刷
control-key = 按键 { $number }
control-barrel = 笔按钮 { $number }
control-eraser = 橡皮
control-wheel = 滚轮 { $number }
control-ring = 圆环 { $number }
control-strip = 触条 { $number }

## Page: loop

loop-heading = 循环
loop-tick = 节拍
loop-late = 延迟
loop-samples = 采样
loop-dabs = 点按
loop-lost = 丢失
    .note = 丢失: 移动 + 接触; 后者恒为 0
loop-window = 此窗口
loop-frames = 帧/秒
loop-frame = 帧
loop-worst = 最差
loop-to-clay = 到黏土
loop-to-screen = 到屏幕
    .note = 到黏土、到屏幕: 从最新采样起
loop-in-view = 可见
loop-of = { $part } / { $all }
loop-uploaded = 已上传
loop-object = 物体
loop-vertices = 顶点
loop-triangles = 三角面
loop-saved = 随工作保存: { $path }
loop-sample-to-screen = 从采样到屏幕
loop-up-to = 至 { $value } ms
loop-longer = 更长
loop-class = { $class }: { $count }
loop-histogram = { $frames } 帧; { $first } ms, 每条加倍
stage-tick = 节拍
    .about = 从读取到取用它的节拍结束
stage-wait = 等待
    .about = 从该节拍结束到一帧开始
stage-draw = 绘制
    .about = 从帧开始到交出图像
stage-present = 呈现
    .about = 从交出到呈现
stage-total = 合计
    .about = 从读取到呈现

## Page: more

preferences-heading = 偏好设置
preferences-language = 语言
preferences-language-system = 跟随系统 ({ $name })
preferences-font = { $name } 需要此计算机缺少的字体。请安装含有其文字的字体, 如 Noto Sans CJK, 然后重新选择语言。
preferences-text-size = 文字大小
preferences-light = 浅色面板
preferences-speed = 速度即压力
    .tip = 用于鼠标: 慢速笔画比快速的压力大
preferences-lead = 笔画显示超前于笔
    .tip = 显示画面可见之前笔将堆起的部分；黏土本身只取决于笔
preferences-fingers = 双指
    .tip = 用于触摸屏。捏合缩放; 三指做另一动作, 三指轻点撤销, 四指轻点重做
preferences-fingers-turn = 旋转
preferences-fingers-slide = 平移
preferences-lesson-skip = 跳过课程
preferences-lesson-again = 重新开始首课
preferences-keys = 按键...
preferences-help = 帮助
preferences-search = 搜索动作
preferences-no-session = 没有会话文件: 只有导出才会保留作品。

messages-heading = 消息
messages-loading = 正在载入 { $name }

## The window of the keys

keys-heading = 按键
keys-set = 方案
keys-as-in-set = 恢复方案
    .tip = 忘记你改过的所有按键
keys-find = 查找
keys-note = 点击动作的按键以更改。
keys-shared = { $count ->
   *[other] { $count } 个动作与别的动作按键相同
}
keys-press = 请按键...
keys-of = { $action } 的按键
    .tip = 点击, 然后按新按键。Esc 不变, Delete 移除
keys-also = 另有: { $actions } (所选者优先)
    .own = 另有: { $actions } (执行此项)
keys-unknown-action = keys.own: 没有名为 "{ $id }" 的动作
keys-unreadable = keys.own.{ $id }: "{ $keys }" 不是按键: 应如 Z、F12、[ 或 Ctrl+Shift+Z

## Search, radial menu, dragged settings, curves

search-heading = 搜索动作
search-nothing = 没有这个名称

radial-radius = 半径
radial-mirror = 镜像 x
radial-thickness = 厚度
radial-frame = 框显
radial-strength = 强度
radial-carve = 雕入

modal-radius = 半径 { $value }: 点击保留, Esc 还原
modal-strength = 强度 { $value }: 点击保留, Esc 还原

curve-note = 绘制或设点: 笔刷跟随之前可更改。
curve-points = { $count ->
   *[other] { $count } 个点
}
curve-draw = 绘制曲线
    .tip = 笔刷作为一步沿其绘制 (Enter)
curve-remove = 移除点
    .tip = Delete, 或在其上按右键
curve-discard = 放弃
    .tip = 不绘制 (Esc)

## The first lesson

lesson-demo = 演示正在运行。可随时触碰黏土
lesson-line = { $hint } ({ $at } / { $all })
lesson-sculpt = 在黏土上按住并拖动
lesson-turn = 在黏土旁拖动以旋转, 滚动以缩放
lesson-smooth = 按住 Shift 划过所做之处: 变光滑
lesson-carve = 按住 Ctrl 并划动: 雕入而非隆起
lesson-undo = { $keys } 撤销上一笔画
lesson-mirror = { $keys }, 或左侧镜像中的 x, 再画一笔: 两侧同时
    .no-keys = 在左侧镜像中选 x, 再画一笔: 两侧同时

## Help

help-heading = 帮助
help-pages = 右侧页面
help-keys = 按键
help-pen = 笔或鼠标
help-pen-press = 在黏土上按住并拖动
    .does = 雕刻
help-pen-carve = 同时按 Ctrl 或 Alt
    .does = 一次笔画内雕入而非隆起
help-pen-smooth = 同时按 Shift
    .does = 一次笔画内光滑
help-pen-turn = 在黏土旁拖动, 或用右键
    .does = 旋转视图
help-pen-slide = 中键, 或 Shift 加右键
    .does = 平移视图
help-pen-zoom = 滚轮
    .does = 靠近指针下之物
help-pen-menu = 按住空格
    .does = 指针周围的菜单
help-fingers = 屏幕上的手指
help-fingers-one = 一指在黏土上
    .does = 雕刻
help-fingers-two = 双指
    .does = 旋转视图; 捏合缩放
help-fingers-three = 三指
    .does = 平移视图 (“更多”页可对调)
help-fingers-tap = 三指、四指轻点
    .does = 撤销、重做
help-hands = 跟踪器上方的双手
help-hands-index = 伸出食指
    .does = 指尖推动黏土
help-hands-pinch = 拇指与食指合拢
    .does = 抓住、搬动、放开黏土
help-hands-flat = 手指伸直并拢
    .does = 手掌按压并抹平
help-hands-open = 手指伸直张开
    .does = 旋转视图; 双手缩放
help-hands-fist = 握拳
    .does = 平移视图
help-hands-both = 双手捏合
    .does = 持住作品: 旋转、移动、缩放
help-hands-menu = 指尖停在左侧的球中
    .does = 从手的菜单中选择
help-work = 作品会保留
help-work-close = 随时关闭窗口
    .does = 会话从原处继续
help-work-files = 文件页
    .does = 打开、导出、先前的作品

## Actions

action-brush = { $brush }笔刷
action-page = 页面: { $page }
action-undo = 撤销
action-redo = 重做
action-carve = 雕入或隆起
action-larger = 增大笔刷
action-smaller = 减小笔刷
action-stronger = 增强笔刷
action-weaker = 减弱笔刷
action-drag-radius = 拖动半径
action-drag-strength = 拖动强度
action-mirror-x = x 镜像
action-mirror-y = y 镜像
action-mirror-z = z 镜像
action-frame = 框显作品
action-front = 前视图
action-back = 后视图
action-left = 左视图
action-right = 右视图
action-top = 顶视图
action-bottom = 底视图
action-perspective = 透视或正交
action-next-material = 下一材质
action-facets = 平滑或平直着色
action-ssao = 环境光遮蔽
action-wireframe = 线框
action-grid = 栅格
action-thickness = 厚度图
action-mask = 遮罩图
action-distance = 距离图
action-trim-box = 以框修剪
action-trim-line = 以线修剪
action-region-lasso = 套索区域
action-region-box = 框选区域
action-region-line = 线区域
action-region-polyline = 折线区域
action-region-mask = 遮罩一个区域
action-region-unmask = 解除区域遮罩
action-region-hide = 隐藏一个区域
action-region-isolate = 仅显示一个区域
action-region-face-set = 由区域建面组
action-finer = 更细级别
action-coarser = 更粗级别
action-remesh = 重构网格
action-try-add = 预览: 合并手持物体
action-try-cut = 预览: 用手持物体切除
action-try-keep = 预览: 保留共有部分
action-open-mesh = 打开网格
action-export = 导出网格
action-screenshot = 截图
action-turntable = 转台帧
action-search = 搜索动作
action-panels = 面板
action-light-or-dark = 浅色或深色
action-larger-text = 增大文字
action-smaller-text = 减小文字
action-help = 帮助
action-keys = 更改按键
action-lesson = 首课

## Messages of background tasks

task-loaded = { $name }: { $count } 个顶点
task-loop-ended = 循环已结束
task-exported = 已保存 { $path }: { $x } x { $y } x { $z } { $unit }
task-saved = 已保存 { $path }
task-frames = 已将 { $frames } 帧保存到 { $folder }
task-failed = { $path }: { $error }
task-done = { $operation }: 完成
task-snapped = 两个面已贴合
task-trimmed = 已修剪
task-level = 级别 { $at } / { $all }
task-remesh-local = 已更改的边：{ $count }
task-remesh-taken-back = 重新网格化在完成前已被撤销。
task-remeshed = 已重构网格: { $count } 个三角面, 体素 { $voxel }, 体积 { $change } %; 相交: { $crossings }
task-quads = 四边形 { $quads }, 三角面 { $triangles }; 相交: { $crossings }
task-decimated = 三角面由 { $before } 减为 { $now }; 新相交: { $crossings }
task-layers-baked = 烘焙到新表面的图层: { $count }
task-sets-made = 已创建面组
task-mask-measured = 已遮罩：{ $count } 个顶点
task-sets-dropped = 面组已随旧表面一起移除；不再隐藏任何部分
task-extracted = 已提取含 { $count } 个顶点的对象
task-preferences-unreadable = { $path }: { $error }; 已保留为 { $aside }
task-preferences-stuck = { $path }: { $error }; 无法另存: { $why }
task-preferences-unread = { $path }: 无法读取偏好设置: { $error }
task-preferences-not-kept = { $path }: 偏好设置未保存: { $error }
language-unreadable = { $path }: { $error }
